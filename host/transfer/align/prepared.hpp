// SPDX-License-Identifier: MIT
#pragma once
/// \file Sample and upper made ready for registration: what of them is common.

#include <memory>
#include <vector>

#include "common/core/result.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/transfer/align/nearest_table.hpp"
#include "host/transfer/align/rim.hpp"
#include "host/transfer/align/shoe_axes.hpp"
#include "host/transfer/align/surfels.hpp"

namespace biteline::transfer {

// The groove and the sole's edge reach this far above the line; above it sample and upper are the same
// surface.
inline constexpr double k_groove_margin_mm = 5;
/// Surfaces farther apart are no pair.
inline constexpr double k_fine_reach_mm = 5;

/// A place of the wall unrolled: along the line, and up from it.
struct OnWall {
  double along_mm, up_mm;
};

/// A finished sample made ready: what of it an upper has too, in the sample's own axes.
struct Sample {
  SE3 T_base_shoe{SE3::Identity()};  ///< of the sample, where it was scanned
  ShoeAxes axes{};
  Surfels common{};  ///< above the line, in the shoe frame
  Surfels common_coarse{};
  Rim rim{};  ///< in the shoe frame
  std::vector<Vec3> line_shoe{};
  double line_length_mm{0};
  std::shared_ptr<const NearestTable> common_table{};   ///< of `common`; null: not made
  std::vector<OnWall> common_on_wall{}, rim_on_wall{};  ///< of each surfel of `common`, each place of `rim`
};

/// Pre: a line of at least 3 points.  Fails (Refused) when next to nothing lies above the line.
[[nodiscard]] Result<Sample> prepare_sample(const cloud::PointCloud& cloud, const cloud::ClosedLine& line);

/// The current upper, made ready.
struct Upper {
  ShoeAxes axes{};
  Surfels surfels{};
  Surfels surfels_coarse{};
  Rim rim{};
};

/// Fails (Refused) when the cloud holds no surface of a shoe's size.
[[nodiscard]] Result<Upper> prepare_upper(const cloud::PointCloud& cloud);

/// Turned by half a turn about base's x.
[[nodiscard]] Upper turned_over(const Upper& upper);

/// What of a sample an upper has too, in its shoe frame.
[[nodiscard]] Upper upper_of(const Sample& sample);

/// The sample as of the other foot: its shoe frame's y turned round.
[[nodiscard]] Sample mirrored(const Sample& sample);

}  // namespace biteline::transfer
