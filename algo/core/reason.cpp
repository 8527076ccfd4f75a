#include "core/reason.hpp"

namespace berth {

const char* reason_name(Reason reason) {
  switch (reason) {
    case Reason::kNone:
      return "";
    case Reason::kBadFrame:
      return "bad_frame";
    case Reason::kLowContrast:
      return "low_contrast";
    case Reason::kNoCircle:
      return "no_circle";
    case Reason::kNoLine:
      return "no_line";
    case Reason::kLayoutMismatch:
      return "layout_mismatch";
    case Reason::kDotMissing:
      return "dot_missing";
    case Reason::kSaturated:
      return "saturated";
    case Reason::kDegenerate:
      return "degenerate";
    case Reason::kNoSolution:
      return "no_solution";
    case Reason::kResidualTooLarge:
      return "residual_too_large";
    case Reason::kAmbiguous:
      return "ambiguous";
    case Reason::kImprecise:
      return "imprecise";
    case Reason::kPoolFull:
      return "pool_full";
    case Reason::kDeadline:
      return "deadline";
    case Reason::kCount:
      break;
  }
  return "unknown";
}

}  // namespace berth
