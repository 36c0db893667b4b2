// SPDX-License-Identifier: MIT
#pragma once
/// \file A picture file as ROS 2's sensor_msgs/CompressedImage in CDR (little-endian): what viewers know.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::recording {

/// `file`: a whole PNG file.
[[nodiscard]] std::vector<std::uint8_t> picture_message(std::int64_t stamp_ns,
                                                        std::span<const std::uint8_t> file);
/// The file in it; Errc::BadFormat.
[[nodiscard]] Result<std::span<const std::uint8_t>> picture_file_of(std::span<const std::uint8_t> message);

inline constexpr const char* k_picture_schema_name = "sensor_msgs/msg/CompressedImage";
inline constexpr const char* k_picture_schema =
    "std_msgs/Header header\n"
    "string format\n"
    "uint8[] data\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "builtin_interfaces/Time stamp\n"
    "string frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\n"
    "int32 sec\n"
    "uint32 nanosec\n";

}  // namespace biteline::recording
