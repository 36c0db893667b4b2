// SPDX-License-Identifier: MIT
#pragma once
/// \file What stands where in a recording's MCAP file (docs/recording.md).

#include <array>
#include <string_view>

namespace biteline::recording {

namespace topic {
inline constexpr const char* k_frame = "/cam0/frame";    ///< JSON, a row of the tables; before its picture
inline constexpr const char* k_picture = "/cam0/image";  ///< sensor_msgs/CompressedImage as CDR
inline constexpr const char* k_pose = "/pose0/pose";     ///< JSON, a row of pose0/data.csv
inline constexpr const char* k_scan = "/scan/message";   ///< the sensor's messages as they came
inline constexpr const char* k_event = "/scan/event";    ///< JSON: the scan's begin and end, for people
// With --ros2, in CDR and metres; they tell what stands in the others, and an import does without them.
inline constexpr const char* k_ros_pose = "/pose0/pose_stamped";  ///< geometry_msgs/PoseStamped, base
inline constexpr const char* k_ros_points = "/scan/points";       ///< sensor_msgs/PointCloud2, base
}  // namespace topic

/// Attached under these names, and taken out again under no others.
struct KeptFile {
  std::string_view name;  ///< in the session; `results/` is of a result folder
  std::string_view media_type;
};
inline constexpr std::array k_kept_files{KeptFile{"cam0/sensor.yaml", "application/yaml"},
                                         KeptFile{"cam0/uncertainty.yaml", "application/yaml"},
                                         KeptFile{"recording.yaml", "application/yaml"},
                                         KeptFile{"settings.yaml", "application/yaml"},
                                         KeptFile{"results/report.json", "application/json"},
                                         KeptFile{"results/line.csv", "text/csv"},
                                         KeptFile{"results/gate.json", "application/json"}};
inline constexpr std::string_view k_results_prefix = "results/";

}  // namespace biteline::recording
