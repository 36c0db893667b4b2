// SPDX-License-Identifier: MIT
#include "hal/sim/record/disturbances.hpp"

#include <cmath>
#include <numbers>

namespace biteline::sim {

namespace {

/// Twice the mains' frequency, a little off the camera's rate: the lamps beat.
constexpr double k_flicker_hz = 100.3;
/// The light of the room goes in steps, so that the renderer keeps a background for each.
constexpr double k_steps = 4;

}  // namespace

void disturb(Shot& shot, const Disturbances& disturbances, const SE3& T_scene_begin, const SE3& T_scene_end,
             double time_s) {
  shot.speckle_stays_put = disturbances.speckle_on_surface;
  const double phase = std::remainder(time_s * k_flicker_hz, 1.0) * 2 * std::numbers::pi;
  shot.ambient_ratio = 1 + disturbances.lamp_flicker_ratio * std::round(k_steps * std::sin(phase)) / k_steps;
  if (!disturbances.motion_blur) return;
  const SE3 T_begin_end = T_scene_begin.inverse(Eigen::Isometry) * T_scene_end;
  shot.moved_cam_mm = T_begin_end.translation();
  shot.turned_cam_rad = geometry::log_so3(T_begin_end.linear());
}

}  // namespace biteline::sim
