// Ends of the line for broken contracts: a record and a reset, without the runtime library's
// versions, which print and allocate.
#include <exception>

#include "core/check.hpp"
#include "hal/fault.hpp"

// gsl::span calls this for an index outside its bounds. Defined here, the library's is not linked,
// nor its demangler, its allocator and its standard error.
void std::terminate() noexcept { berth::hal::fault_stop(berth::hal::FaultKind::kTerminate); }

void berth::range_violation(const char*) {
  berth::hal::fault_stop(berth::hal::FaultKind::kRangeViolation);
}

// A pure virtual call cannot happen without virtual functions; destructors of statics never run.
extern "C" void abort() { berth::hal::fault_stop(berth::hal::FaultKind::kTerminate); }
