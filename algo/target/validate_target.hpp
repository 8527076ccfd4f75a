// Validation of a target description: what the chain may rely on after the parameter block is in.
//
// Accepted are targets of 0.25 to 4 times CT-1's size: sides of the plate 30 to 480 mm, markers of
// at least 0.5 mm, everything on the plate, 3 to 8 dots that neither overlap nor lie on one line
// (in space: three dots are a triple for P3P). Only dots[0] may be raised (z < 0).
#pragma once

#include "core/field_fault.hpp"
#include "target/model.hpp"

namespace berth {

constexpr Mm kMinPlateSide = q<18>(30.0);
constexpr Mm kMaxPlateSide = q<18>(480.0);
constexpr Mm kMinMarkerSize = q<18>(0.5);
constexpr std::int32_t kMinDots = 3;

/// The first field that is out of range or contradicts another, in the order of the struct.
/// Any bit pattern is a legal input. Cost: some hundred operations.
FieldFault validate_target(const TargetModel& target);

}  // namespace berth
