// SPDX-License-Identifier: MIT
#pragma once
/// \file A scanning head of round numbers: laser and camera axis meet at 45 degrees, 200 mm in front of the
/// camera.

#include "common/geometry/sensor_model.hpp"

namespace biteline::test {

/// Its region is the sensor's middle.
inline geometry::SensorModel made_head(int width_px, int height_px) {
  constexpr int k_sensor_width_px = 1626, k_sensor_height_px = 1236;
  geometry::SensorModel sensor;
  sensor.camera = {.fu_px = 2730,
                   .fv_px = 2712,
                   .cu_px = 815,
                   .cv_px = 620,
                   .k1 = -0.11,
                   .k2 = 0.14,
                   .p1 = 0.0003,
                   .p2 = -0.0002,
                   .k3 = 0};
  sensor.laser_plane = {.normal_cam = Vec3{0.002, 0.7071, -0.7071}.normalized(), .distance_mm = -141.4};
  sensor.T_flange_cam.linear() = Eigen::AngleAxisd(0.76, Vec3::UnitX()).toRotationMatrix();
  sensor.T_flange_cam.translation() = Vec3{9, 153, 250};
  sensor.region = {.offset_u_px = (k_sensor_width_px - width_px) / 2,
                   .offset_v_px = (k_sensor_height_px - height_px) / 2,
                   .width_px = width_px,
                   .height_px = height_px};
  return sensor;
}

}  // namespace biteline::test
