// SPDX-License-Identifier: MIT
#pragma once
/// \file What the face offers: its own registers, and their GenICam description.

#include <cstdint>
#include <string>
#include <string_view>

namespace biteline::gige {

/// Registers of our own, 32 bits each.
namespace own {
inline constexpr std::uint32_t k_sensor_width = 0xa000, k_width = 0xa004, k_height = 0xa008;
inline constexpr std::uint32_t k_pixel_format = 0xa00c, k_payload_size = 0xa010;
inline constexpr std::uint32_t k_acquisition_mode = 0xa014, k_acquisition = 0xa018, k_locked = 0xa01c;
inline constexpr std::uint32_t k_chunk_mode = 0xa020, k_scan_type = 0xa024;
inline constexpr std::uint32_t k_binning = 0xa028;
inline constexpr std::uint32_t k_coordinate_selector = 0xa040, k_output_mode = 0xa044, k_unit = 0xa048;
inline constexpr std::uint32_t k_system = 0xa04c, k_reference = 0xa050, k_invalid_flag = 0xa054;
inline constexpr std::uint32_t k_invalid_value = 0xa058;
/// Of A, + 4 of B, + 8 of C.
inline constexpr std::uint32_t k_scale = 0xa060, k_offset = 0xa070;
/// The description itself.
inline constexpr std::uint32_t k_description = 0x1'0000;
}  // namespace own

/// Values of Scan3dOutputMode.
inline constexpr std::uint32_t k_calibrated_grid = 1, k_calibrated_depth = 2, k_calibrated_profile = 3;
/// Profiles of a frame, at most; and rows of a picture.
inline constexpr std::uint32_t k_most_lines = 1024, k_most_height = 65'535;

inline constexpr std::string_view k_own_vendor = "Biteline", k_own_model = "LaserProfileSensor";

[[nodiscard]] std::string device_description();

}  // namespace biteline::gige
