// SPDX-License-Identifier: MIT
#pragma once
/// \file What a real cell does to a scan, and how much of it is simulated.

#include "hal/sim/render/stripe_renderer.hpp"
#include "hal/sim/robot/joint_dynamics.hpp"

namespace biteline::sim {

/// Without any: an exact arm, pictures of an instant, no light but the laser's.
struct Disturbances {
  ArmDynamics arm{};
  bool motion_blur{false};  ///< the exposure lasts, and the head moves meanwhile
  bool speckle_on_surface{
      false};  ///< speckle stays where it is on the surface; else each picture draws its own
  double lamp_flicker_ratio{0};  ///< of SceneSettings::ambient_grey, up and down a hundred times a second
};

/// As a cell in a hall has them.
[[nodiscard]] constexpr Disturbances common_disturbances() {
  return {.arm = common_arm_dynamics(),
          .motion_blur = true,
          .speckle_on_surface = true,
          .lamp_flicker_ratio = 0.3};
}

/// An exposure from `T_scene_begin` to `T_scene_end` of the camera; `time_s` tells the lamps' phase.
void disturb(Shot& shot, const Disturbances& disturbances, const SE3& T_scene_begin, const SE3& T_scene_end,
             double time_s);

}  // namespace biteline::sim
