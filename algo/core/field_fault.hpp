// Which value of a parameter struct is not acceptable: a name that an operator can look up.
#pragma once

#include <cstdint>

namespace berth {

/// `field` is a static text ("camera.fx", "target.dots[].radius_mm"), null where all is well;
/// `index` belongs between its brackets, -1 where there are none.
struct FieldFault {
  const char* field = nullptr;
  std::int32_t index = -1;

  constexpr bool is_fault() const { return field != nullptr; }
};

}  // namespace berth
