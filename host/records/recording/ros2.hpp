// SPDX-License-Identifier: MIT
#pragma once
/// \file Poses and points as ROS 2's messages (common_interfaces), in CDR.  Lengths in metres (REP 103),
/// frame `base`.

#include <cstdint>
#include <string>
#include <vector>

#include "common/profile/profile.hpp"
#include "common/recording/rows.hpp"

namespace biteline::recording::ros2 {

inline constexpr const char* k_pose_schema_name = "geometry_msgs/msg/PoseStamped";
inline constexpr const char* k_points_schema_name = "sensor_msgs/msg/PointCloud2";

/// The definitions as ROS 2's tools write them into MCAP files: the message's, then those that it names.
[[nodiscard]] std::string pose_schema();
[[nodiscard]] std::string points_schema();

/// Of the flange, at its time on the camera's clock.
[[nodiscard]] std::vector<std::uint8_t> pose_message(std::int64_t camera_ns, const PoseRow& row);

/// The points of a profile that are surface: x, y, z and intensity (grey levels of the stripe's height),
/// FLOAT32, one row.
[[nodiscard]] std::vector<std::uint8_t> points_message(const profile::Profile& profile,
                                                       const SE3& T_flange_cam);

}  // namespace biteline::recording::ros2
