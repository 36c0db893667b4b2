// SPDX-License-Identifier: MIT
#pragma once
/// \file The range that a head can see, in depth and across, and the scales that hold it in 16 bits.

#include "common/geometry/sensor_model.hpp"
#include "host/interfaces/gige/frame.hpp"

namespace biteline::gige {

/// From where the laser plane meets the rays of the region's corners.  Where a corner looks past the plane:
/// 0.01 mm a step from 0.
[[nodiscard]] Depth depth_of(const geometry::SensorModel& model);

}  // namespace biteline::gige
