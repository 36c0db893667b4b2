// SPDX-License-Identifier: MIT
#pragma once
/// \file What an arm's joints give while it moves, and how far that takes the tool off its line.

#include <span>
#include <vector>

#include "host/robot/path/joint_path.hpp"

namespace biteline::path {

/// A place of a timed path.
struct GivePlace {
  kinematics::Joints q_rad{kinematics::Joints::Zero()};
  Vec3 work_base{Vec3::Zero()};  ///< the point of the line that the tool works at
  double arc_mm{0};              ///< of the tip
  double speed_mm_s{0};          ///< of the tip
  double time_s{0};
};

/// Slow motion's give at one place, of what the tool works at, across the line, in base: a joint's links hang
/// on its drive by a spring, so that they lag by its acceleration over w^2 (Spong 1987: elastic joints).
struct GiveRate {
  Vec3 per_acceleration{Vec3::Zero()};  ///< mm for each mm/s^2 of the tip along its way
  Vec3 per_speed2{Vec3::Zero()};        ///< mm for each (mm/s)^2 of the tip: the way's bend
};
[[nodiscard]] std::vector<GiveRate> give_rates(const kinematics::ArmModel& arm,
                                               std::span<const GivePlace> places);

/// The largest give on the way to each place, mm, as `GiveRate` has it, with each joint's ringing: linear
/// springs, at rest at the first place, each with its own frequency and damping.  Pre: times do not fall.
[[nodiscard]] std::vector<double> give_along_mm(const kinematics::ArmModel& arm,
                                                std::span<const GivePlace> places);

}  // namespace biteline::path
