// SPDX-License-Identifier: MIT
#pragma once
/// \file What a scan would have shown if its pictures were otherwise than they came: mirrored, turned, of
/// another scale, moved.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "host/calibration/drift/scan_view.hpp"

namespace biteline::consistency {

/// What may have been done to the pictures since the calibration.
enum class PictureMove : std::uint8_t { Mirrored, UpsideDown, Turned, Halved };
inline constexpr std::array k_picture_moves{PictureMove::Mirrored, PictureMove::UpsideDown,
                                            PictureMove::Turned, PictureMove::Halved};
/// "mirrored left to right": after "as if the pictures were".
[[nodiscard]] std::string_view words_of(PictureMove move);

/// Points of profiles, by these' numbers.
struct ProfilePoints {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> profile;

  [[nodiscard]] drift::ScanView view(std::span<const drift::PosedProfile> poses) const {
    return {points, profile, poses};
  }
};

/// The scan's points with the move taken back, without those of which the picture has no such place.
[[nodiscard]] ProfilePoints taken_back(const drift::ScanView& scan, const geometry::SensorModel& head,
                                       PictureMove move);
/// The same of pictures whose stripe came `px` beside where it should: columns, rows.
[[nodiscard]] ProfilePoints place_taken_back(const drift::ScanView& scan, const geometry::SensorModel& head,
                                             const Vec2& px);

}  // namespace biteline::consistency
