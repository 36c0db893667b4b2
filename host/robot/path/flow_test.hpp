// SPDX-License-Identifier: MIT
#pragma once
/// \file A test of gun and pump: strokes at several speeds on a flat plate, and the delays that their films
/// tell.

#include <optional>
#include <span>
#include <vector>

#include "host/robot/path/plan.hpp"

namespace biteline::path {

/// Level, its middle and the way of the first stroke in the line's frame.
struct FlowPlate {
  Vec3 middle{Vec3::Zero()};  ///< of its top, mm
  double turn_rad{0};         ///< about z, from x
};

/// The request's process on the plate, its tool straight down, all delays told as none: four strokes, two
/// each way, at 0.4, 1, 0.7 and, with a pump, first 1 then 0.4 of its speed.  Film ends before each stroke
/// does. Errc::InvalidArgument: a process without an output.
[[nodiscard]] Result<void> ask_for_flow_test(PlanRequest& request, const FlowPlate& plate);

/// One stroke as it is planned.
struct FlowStroke {
  Vec3 begins_base{Vec3::Zero()}, ends_base{Vec3::Zero()};  ///< of its film, where it were without delays
  double speed_mm_s{0};                                     ///< where it ends
  std::optional<double> step_mm{};  ///< of the place where the speed changes, from its beginning
};
/// In the order in which the program lays them.  Pre: planned from such a request.
[[nodiscard]] std::vector<FlowStroke> flow_strokes(const PlannedPath& path);

/// Of one stroke, along its way, mm.
struct MeasuredStroke {
  double begin_mm{0};                    ///< of the film, behind its mark
  double end_mm{0};                      ///< likewise
  std::optional<double> widest_ratio{};  ///< of its width at the step, over its width behind that
};

struct FlowFit {
  double gun_on_s{0}, gun_off_s{0};
  std::optional<double> lag_s{};  ///< none: no stroke had a step
  double shift_mm{0};             ///< of the plate along the first stroke
  double rms_mm{0};               ///< of what ends and beginnings leave
};

/// Ends lie behind by speed times delay, and the plate's shift tells itself by strokes the other way (least
/// squares); beginnings by the way that the tip's ramp makes in the delay; what is too wide at the step by a
/// first-order lag. Errc::InvalidArgument: not as many strokes as the path has, or values that no delay
/// gives.
[[nodiscard]] Result<FlowFit> fit_flow(const PlannedPath& path, std::span<const MeasuredStroke> measured);

}  // namespace biteline::path
