// SPDX-License-Identifier: MIT
#pragma once
/// \file A program that presses, run in made time: its moves, its threads, the force mode, the contact.

#include <memory>
#include <vector>

#include "hal/sim/robot/contact_flange.hpp"
#include "hal/sim/robot/force_control.hpp"
#include "hal/sim/robot/program.hpp"

namespace biteline::sim {

/// One cycle of the controller.
struct PressStep {
  double time_s{0};
  Vec3 tip_base{Vec3::Zero()};     ///< of the program, mm
  Vec3 off_base{Vec3::Zero()};     ///< of force mode, from there, mm
  Vec3 true_newton{Vec3::Zero()};  ///< on the tool, base axes
  Vec3 told_newton{Vec3::Zero()};  ///< by the sensor
  bool force_mode{false};          ///< or its flange is on
  double volts{0};                 ///< of a flange's reading
  int told{0};                     ///< by the program, in the output register that was asked for
};

struct PressRun {
  std::vector<PressStep> steps;
  bool halted{false};  ///< by a thread
};

/// Cycle by cycle, until the program ends.  `touch` is asked once each cycle; none: the tool meets nothing.
/// `output_register`: the one whose values are kept.
[[nodiscard]] PressRun press_along(const std::shared_ptr<const Program>& program, const ForceFacts& facts,
                                   const Touch& touch, int output_register, double step_s = 0.002);
/// The same by a flange: `told_newton` is what it reads, against its axis.
[[nodiscard]] PressRun press_along(const std::shared_ptr<const Program>& program, const FlangeFacts& facts,
                                   const Touch& touch, int output_register, double step_s = 0.002);

}  // namespace biteline::sim
