// SPDX-License-Identifier: MIT
#pragma once
/// \file Normals and mean curvature of a scan's points while its profiles come in.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "host/cloud/curvature/batch.hpp"

namespace biteline::curvature {

/// The neighbours of a point stand in its own profile and in those beside it, at about its column: no tree is
/// needed, and a profile is done with as soon as the scan has gone on by the radius.  Along each profile,
/// runs of 0.25 mm are averaged; normals are PCA planes and curvature the level-set quadric
/// through the runs within the radius.
///
/// Threads: one at a time.  Memory: 16 bytes per point for the results, and the last profiles.
class ScanSurface {
 public:
  ScanSurface();

  /// The points of the next profile in base, finite, in rising order of their columns; `eye_base`: the
  /// camera's centre, which is outside.
  void add_profile(std::span<const Eigen::Vector3f> points_base, std::span<const std::uint16_t> columns,
                   const Eigen::Vector3f& eye_base);
  /// No more profiles come: what still waited for its neighbours is done with those there are.
  void finish();

  /// Per point that is done, in the order in which they came: unit normal, outward.  A point without
  /// neighbours in other profiles has the direction to the camera, made perpendicular to the stripe.
  [[nodiscard]] const std::vector<Eigen::Vector3f>& normals() const { return normals_; }
  [[nodiscard]] std::vector<Eigen::Vector3f> take_normals() { return std::move(normals_); }
  /// The same: 1/mm, convex > 0; NaN where there are too few neighbours to tell.
  [[nodiscard]] const std::vector<float>& mean_per_mm() const { return mean_per_mm_; }
  [[nodiscard]] std::vector<float> take_mean_per_mm() { return std::move(mean_per_mm_); }

 private:
  /// Neighbouring points of a profile, averaged.
  struct Run {
    Eigen::Vector3f place_mm, normal;
    float column;
    float mean_per_mm;
    std::uint32_t points;
  };
  struct Row {
    Eigen::Vector3f eye;
    float way_mm;  ///< how far the scan has gone over the surface
    std::vector<Run> runs;
    std::vector<std::uint16_t> columns;  ///< of its points
    float radius_mm{0};
    /// Rows that have its neighbours, its own first: numbers since the scan's beginning.
    std::array<std::size_t, 5> beside{};
    std::size_t beside_count{0};
  };

  [[nodiscard]] Row& row(std::size_t number) { return rows_[number - first_row_]; }
  [[nodiscard]] std::size_t end_row() const { return first_row_ + rows_.size(); }
  void choose_neighbours(std::size_t number);
  void settle(bool all);
  template <class Use>
  void for_each_batch(Row& of, bool with_normals, Use&& use);
  void fit_normals(Row& of);
  void fit_curvature(Row& of);
  void give_out(const Row& of);

  std::deque<Row> rows_;
  std::size_t first_row_{0};  ///< number of rows_.front()
  std::size_t with_normals_{0}, given_out_{0};
  std::unique_ptr<Batch> batch_;
  std::vector<Eigen::Vector3f> normals_;
  std::vector<float> mean_per_mm_;
};

}  // namespace biteline::curvature
