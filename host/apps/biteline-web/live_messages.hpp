// SPDX-License-Identifier: MIT
#pragma once
/// \file The binary messages of /api/v1/live, as host/web/openapi.yaml describes them.  Little endian.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/profile/profile.hpp"
#include "common/wire/messages.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::web {

enum class LiveKind : std::uint8_t {
  Picture = 1,
  Profile = 2,
  Cloud = 3,
  Line = 4,
  Arm = 5,
  Peaks = 6,
  Sensor = 7
};
inline constexpr std::size_t k_live_kinds = 8;  ///< by LiveKind; 0 is not used

/// Shared by all who watch: made once.
using LiveBytes = std::shared_ptr<const std::string>;

struct LiveStamp {
  std::uint32_t sequence{0};
  std::uint64_t time_ns{0};  ///< sensor clock
};
[[nodiscard]] LiveBytes picture_message(LiveStamp stamp, std::span<const std::uint8_t> jpeg);

/// What was found in the picture of that number, and which part of the sensor it shows.
[[nodiscard]] LiveBytes peaks_message(const wire::Picture& picture);

/// The sensor's own state as JSON.
[[nodiscard]] LiveBytes sensor_message(const std::string& json);

/// x and z of each point in the camera's frame [mm]; the flag's low byte is what the page colours by.
[[nodiscard]] LiveBytes profile_message(const profile::Profile& profile);

struct LivePoint {
  Eigen::Vector3f point_base;  ///< mm
  float curvature_per_mm{0};   ///< of its profile, concave above 0; NaN: unknown
  float sigma_mm{0};           ///< of its place in the picture, see ProfilePoint
};
[[nodiscard]] LiveBytes cloud_message(std::uint32_t scan, std::span<const LivePoint> points);

[[nodiscard]] LiveBytes line_message(const cloud::ClosedLine& line);  ///< u95 is NaN where it is not known

struct ArmPlace {
  double time_s{0};  ///< the controller's own clock
  std::array<double, 6> joints_rad{};
  std::array<double, 3> tip_base_mm{};
};
[[nodiscard]] LiveBytes arm_message(const ArmPlace& place);

}  // namespace biteline::web
