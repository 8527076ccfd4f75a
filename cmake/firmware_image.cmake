# berth_firmware_image(NAME SOURCE...): an image NAME.elf in the build folder's root, linked for the
# board with the reference parts' true region sizes. A region that overflows fails the link.
function(berth_firmware_image name)
  set(linker_folder ${PROJECT_SOURCE_DIR}/linker)
  add_executable(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE berth_app berth_hal_board)
  target_link_options(${name} PRIVATE
    -L${linker_folder} -T${linker_folder}/mps2_an500.ld
    -Wl,-Map=${PROJECT_BINARY_DIR}/${name}.map -Wl,--print-memory-usage)
  set_target_properties(${name} PROPERTIES
    SUFFIX .elf
    RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}
    LINK_DEPENDS "${linker_folder}/mps2_an500.ld;${linker_folder}/sections.ld")
endfunction()
