// SPDX-License-Identifier: MIT
#pragma once
/// \file The points of a scan as the steps take them: organised and scattered clouds by one door.

#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "host/bite_line/large.hpp"
#include "host/bite_line/shoe/shoe.hpp"
#include "host/cloud/uncertainty/arm_sway.hpp"
#include "host/cloud/uncertainty/scan_spread.hpp"

namespace biteline::bite_line {

/// Neighbours along a stripe make a run; its mean stands for it wherever the line is found, its own points
/// wherever the line is placed.  A scattered cloud is runs of one.  Base, mm, finite; borrowed.
struct ScanPoints {
  std::span<const Eigen::Vector3f> means;             ///< of the runs
  std::span<const Eigen::Vector3f> points;            ///< run after run
  std::span<const std::uint32_t> first_point;         ///< of each run; empty: runs of one
  std::span<const uncertainty::ProfilePose> poses{};  ///< in the order of time; empty: not known
  std::optional<uncertainty::ArmMotion> arm{};        ///< how far it was off its told poses

  [[nodiscard]] static ScanPoints scattered(std::span<const Eigen::Vector3f> points) {
    return {.means = points, .points = points, .first_point = {}};
  }
  [[nodiscard]] std::span<const Eigen::Vector3f> run(std::size_t i) const {
    if (first_point.empty()) return points.subspan(i, 1);
    const std::size_t end = i + 1 < first_point.size() ? first_point[i + 1] : points.size();
    return points.subspan(first_point[i], end - first_point[i]);
  }
  [[nodiscard]] double points_per_run() const {
    return static_cast<double>(points.size()) / static_cast<double>(means.size());
  }
};

/// All points of the runs behind these points of the shoe (indices into its `points`), in shoe.
[[nodiscard]] Large<Eigen::Vector3f> points_behind(const ScanPoints& scan, const Shoe& shoe,
                                                   std::span<const std::uint32_t> of_shoe);

}  // namespace biteline::bite_line
