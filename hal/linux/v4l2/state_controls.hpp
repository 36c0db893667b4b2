// SPDX-License-Identifier: MIT
#pragma once
/// \file geometry::CameraState by V4L2's controls: they keep what the last program set, until power goes.

#include <span>

#include "common/geometry/camera_state.hpp"

namespace biteline::hal {

/// Sets what is told and what a driver lists, on the first of `devices` that has it (the sensor's sub-device,
/// the capture node).  A control that is read-only or grabbed stays: read_state_controls() shows it.
void set_state_controls(std::span<const int> devices, const geometry::CameraState& wanted);

/// Into `state`: what the drivers tell.  A sub-device's binning as well, where it crops more than it gives
/// out.
void read_state_controls(std::span<const int> devices, geometry::CameraState& state);

/// Of a sub-device's pad 0: what its pipeline gives out; {0, 0} where it is none.
struct PipelineSize {
  int width_px{0}, height_px{0};
};
[[nodiscard]] PipelineSize pipeline_size(int sub_device);

}  // namespace biteline::hal
