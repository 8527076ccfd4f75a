# Header-only packages (Eigen, gsl) as one target, berth_headers, on both platforms.
#
# On the Arm target /usr/include must not become a search path: it would hide newlib's headers
# behind the host's. The two packages are linked into a folder of their own instead.
add_library(berth_headers INTERFACE)
if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
  set(BERTH_HOST_INCLUDE /usr/include CACHE PATH "Where the host has eigen3/ and gsl/")
  set(staged ${PROJECT_BINARY_DIR}/staged_include)
  foreach(package IN ITEMS eigen3/Eigen gsl)
    set(source ${BERTH_HOST_INCLUDE}/${package})
    if(NOT EXISTS ${source})
      message(FATAL_ERROR "${source} is missing: install libeigen3-dev and libmsgsl-dev")
    endif()
    get_filename_component(name ${package} NAME)
    file(MAKE_DIRECTORY ${staged})
    file(CREATE_LINK ${source} ${staged}/${name} SYMBOLIC)
  endforeach()
  target_include_directories(berth_headers SYSTEM INTERFACE ${staged})
else()
  find_package(Eigen3 3.4 REQUIRED NO_MODULE)
  target_link_libraries(berth_headers INTERFACE Eigen3::Eigen)
endif()
