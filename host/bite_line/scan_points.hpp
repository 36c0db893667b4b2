// SPDX-License-Identifier: MIT
#pragma once
/// \file The points of a scan as the steps take them: organised and scattered clouds by one door.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "host/bite_line/pooled_vector.hpp"
#include "host/bite_line/shoe/shoe.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/cloud/uncertainty/arm_sway.hpp"
#include "host/cloud/uncertainty/scan_spread.hpp"

namespace biteline::bite_line {

/// Neighbours along a stripe are some 0.07 mm apart: their means over a quarter of a millimetre carry all
/// that finding the line needs.
struct Run {
  Eigen::Vector3f mean;
  std::size_t end;  ///< in the points, behind its last one
};
[[nodiscard]] inline Run run_from(std::span<const Eigen::Vector3f> points, std::size_t first) {
  constexpr float k_run_mm = 0.25F;
  const Eigen::Vector3f& start = points[first];
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  std::size_t end = first + 1;
  for (; end < points.size() && (points[end] - start).squaredNorm() < k_run_mm * k_run_mm; ++end)
    sum += points[end] - start;
  return {.mean = start + sum / static_cast<float>(end - first), .end = end};
}

/// The laser's stripe over a run, as the sensor measured it: what its surface is made of shows in it.
struct RunLook {
  static constexpr float k_unknown = -1e6F;
  float log_amplitude{k_unknown};
  float log_width{k_unknown};
};
/// Of the means over `stripe`'s points.  Those of a bracket's longer exposure stay out: their grey levels do
/// not compare with the others'.
[[nodiscard]] RunLook look_of(const cloud::StripeSpan& stripe);

/// The mean of a run stands for it wherever the line is found, its own points wherever the line is placed.
/// Base, mm, finite; borrowed.
struct ScanPoints {
  std::span<const Eigen::Vector3f> means;             ///< of the runs
  std::span<const Eigen::Vector3f> points;            ///< run after run
  std::span<const std::uint32_t> first_point;         ///< of each run; empty: runs of one
  std::span<const uncertainty::ProfilePose> poses{};  ///< in the order of time; empty: not known
  std::optional<uncertainty::ArmMotion> arm{};        ///< how far it was off its told poses
  std::span<const RunLook> looks{};                   ///< of the runs; empty: not known
  bool in_scan_order{false};

  [[nodiscard]] std::span<const Eigen::Vector3f> run(std::size_t i) const {
    if (first_point.empty()) return points.subspan(i, 1);
    const std::size_t end = i + 1 < first_point.size() ? first_point[i + 1] : points.size();
    return points.subspan(first_point[i], end - first_point[i]);
  }
  [[nodiscard]] double points_per_run() const {
    return static_cast<double>(points.size()) / static_cast<double>(means.size());
  }
};

/// The runs of a cloud, as neighbours lie in its own order.
struct PointRuns {
  PooledVector<Eigen::Vector3f> means;  ///< empty: each point is a run
  PooledVector<std::uint32_t> first_point;
  PooledVector<RunLook> looks;  ///< empty: the cloud knows no amplitude
  bool in_scan_order{false};

  [[nodiscard]] ScanPoints scan(std::span<const Eigen::Vector3f> points) const {
    return {.means = means.empty() ? points : std::span<const Eigen::Vector3f>{means},
            .points = points,
            .first_point = first_point,
            .looks = looks,
            .in_scan_order = in_scan_order};
  }
};
/// A profile's end is a run's.  Without profiles, points that hardly have neighbours in their order are left
/// as they are: it is no stripe's, or strays lie among them, which would weigh as much as runs.
[[nodiscard]] PointRuns runs_of(const cloud::PointCloud& cloud);

/// All points of the runs behind these points of the shoe (indices into its `points`), in shoe.
[[nodiscard]] PooledVector<Eigen::Vector3f> points_behind(const ScanPoints& scan, const Shoe& shoe,
                                                          std::span<const std::uint32_t> of_shoe);

}  // namespace biteline::bite_line
