// SPDX-License-Identifier: MIT
#pragma once
/// \file The point cloud of one scan, in base.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace biteline::cloud {

/// The laser's stripe at some points, as the sensor measured it.  Each empty, or one value for each point.
struct StripeSpan {
  std::span<const float> amplitude{};      ///< grey levels above the background; 0: not known
  std::span<const float> width_px{};       ///< full width at half maximum; 0: not known
  std::span<const std::uint16_t> flags{};  ///< profile::PointFlag

  [[nodiscard]] StripeSpan part(std::size_t first, std::size_t count) const {
    const auto of = [&](const auto& values) {
      return values.empty() ? values : values.subspan(first, count);
    };
    return {.amplitude = of(amplitude), .width_px = of(width_px), .flags = of(flags)};
  }
};

/// Points in base, mm, single precision (0.00006 mm at 1 m).  Structure of arrays; every array but `points`
/// is either empty or as long as `points`.  Scan order when `profile` and `column` are there: rising profile,
/// then column.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< outward, unit length
  std::vector<float> mean_per_mm;        ///< mean curvature, convex > 0; NaN where it could not be told
  std::vector<std::uint32_t> profile;    ///< profile's sequence number
  std::vector<std::uint16_t> column;     ///< image column
  std::vector<float> sigma_mm;           ///< standard deviation along the ray
  std::vector<std::uint16_t> flags;      ///< profile::PointFlag
  std::vector<float> amplitude;          ///< of the stripe, grey levels above the background; 0: not known
  std::vector<float> width_px;           ///< of the stripe, full width at half maximum; 0: not known

  [[nodiscard]] std::size_t size() const { return points.size(); }
  [[nodiscard]] bool organised() const { return !profile.empty() && !column.empty(); }
  /// At `count` points from `first` on.
  [[nodiscard]] StripeSpan stripe(std::size_t first, std::size_t count) const {
    return StripeSpan{.amplitude = amplitude, .width_px = width_px, .flags = flags}.part(first, count);
  }
};

}  // namespace biteline::cloud
