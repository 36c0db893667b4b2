// SPDX-License-Identifier: MIT
#pragma once
/// \file The upper border of a scanned shoe (its collar), as registration uses it.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/cloud/point_cloud.hpp"
#include "host/transfer/align/surfels.hpp"

namespace biteline::transfer {

/// A shoe's side is nearly upright: its surface alone fixes the height only weakly, and smooth differences of
/// 0.1 mm between two lasts move it by 0.3 mm.  The collar's edge, where both scans end, fixes it.  Whether
/// they end there because the shoe does, and not the camera's view, shows in whether the two agree
/// (evidence.hpp).
struct Rim {
  std::vector<Eigen::Vector3f> positions{};
  std::vector<Eigen::Vector3f> across{};  ///< unit, in the surface, at right angles to the rim, upwards
  std::vector<Foot> feet{};               ///< as Surfels::feet
  float spacing_mm{0};                    ///< usual distance of neighbours

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] Foot foot(std::size_t i) const { return feet.empty() ? Foot{} : feet[i]; }
};

/// Where the surface ends upwards and nothing lies above within 15 mm: the highest points, to a point's
/// spacing, not to a surfel's.  What ends in the camera's first or last columns ends with its view and is
/// left out, where columns are known. `surfels` are those of `cloud`; its points may come in any order.
[[nodiscard]] Rim rim_of(const cloud::PointCloud& cloud, const Surfels& surfels);

/// Index of the rim's point nearest to `point`.  Pre: the rim is not empty.
[[nodiscard]] std::uint32_t nearest_on(const Rim& rim, const Eigen::Vector3f& point);

}  // namespace biteline::transfer
