// SPDX-License-Identifier: MIT
#pragma once
/// \file The triangle mesh of an organised scan: neighbouring profiles stitched, holes kept, edges not
/// bridged.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "common/core/result.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/transfer/carry/ray.hpp"

namespace biteline::transfer {

/// A scan is a picture of distances: rows are profiles, columns the camera's.  Its mesh needs no search, so
/// none is stored: triangles are made from four neighbouring cells when asked for, and three levels of boxes
/// over the rows lead a ray to them.  600 000 points: some 10 ms, where a tree over 1.2 million triangles
/// takes half a second. Thread: immutable after create(); cast() from any thread.  Memory: a copy of the
/// points and 4 bytes per cell.
class ScanMesh : public RaySurface {
 public:
  struct Limits {
    double max_step_mm{0.8};          ///< neighbours in a profile farther apart: an edge, not bridged
    double max_profile_gap_ratio{3};  ///< profiles farther apart than this many usual distances: a hole
    int max_column_gap{2};            ///< missing columns that still count as neighbours
  };
  using Triangle = std::array<std::uint32_t, 3>;

  /// Fails (InvalidArgument) on a cloud without order, (Refused) on fewer than 2 profiles.
  [[nodiscard]] static Result<ScanMesh> create(const cloud::PointCloud& cloud, const Limits& limits);
  [[nodiscard]] static Result<ScanMesh> create(const cloud::PointCloud& cloud) {
    return create(cloud, Limits{});
  }

  [[nodiscard]] std::optional<Hit> cast(const Ray& ray) const override;

  /// All triangles, anticlockwise seen from outside; indices into points().
  [[nodiscard]] std::vector<Triangle> triangles() const;
  [[nodiscard]] const std::vector<Eigen::Vector3f>& points() const { return points_; }
  [[nodiscard]] bool closed() const { return closed_; }  ///< the last profile is stitched to the first

 private:
  struct Box {
    Eigen::Array3f low, high;

    void take(const Box& other) {
      low = low.min(other.low);
      high = high.max(other.high);
    }
  };
  class BoxTest;
  class Aside;

  static constexpr std::uint32_t k_empty = 0xFFFFFFFF;
  static constexpr std::size_t k_chunk = 32;       ///< columns: 2.5 mm of a profile
  static constexpr std::size_t k_group_rows = 16;  ///< row pairs: 18 mm of the way round
  static constexpr std::size_t k_block = 4;        ///< groups each way: some 150 boxes over a shoe

  ScanMesh() = default;
  [[nodiscard]] Result<void> lay_out(const cloud::PointCloud& cloud, const Limits& limits);
  void measure(const Limits& limits);
  void bound();
  void turn_outward();

  [[nodiscard]] std::uint32_t cell(std::size_t row, std::size_t column) const {
    return cells_[row * width_ + column];
  }
  [[nodiscard]] std::size_t row_pairs() const { return closed_ ? rows_ : rows_ - 1; }
  [[nodiscard]] bool joined_in_profile(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] bool joined_across(std::uint32_t a, std::uint32_t b) const;
  /// The up to two triangles between columns `column`, `column` + 1 of rows `row`, `row` + 1.
  template <class Visit>
  void visit_quad(std::size_t row, std::size_t column, Visit&& visit) const;

  void cast_in_block(const Ray& ray, const BoxTest& test, std::size_t block, Aside& aside,
                     std::optional<Hit>& best) const;
  void cast_in_chunk(const Ray& ray, std::size_t row, std::size_t chunk, Aside& aside,
                     std::optional<Hit>& best) const;
  [[nodiscard]] Vec3 normal_at(std::size_t row, std::size_t column, const Triangle& triangle) const;

  std::vector<Eigen::Vector3f> points_;
  std::vector<std::uint32_t> cells_;  ///< rows_ x width_ indices into points_, k_empty where there is none
  std::size_t rows_{0}, width_{0};
  float step_squared_{0}, gap_squared_{0};
  bool closed_{false};
  bool flipped_{false};      ///< the scan ran the other way round: triangles are turned over
  std::vector<Box> chunks_;  ///< per row pair, every k_chunk columns
  std::vector<Box> groups_;  ///< of k_group_rows row pairs, per chunk
  std::vector<Box> blocks_;  ///< of k_block groups by k_block chunks
  std::size_t block_chunks_{0};
};

template <class Visit>
void ScanMesh::visit_quad(std::size_t row, std::size_t column, Visit&& visit) const {
  const std::size_t next = row + 1 < rows_ ? row + 1 : 0;
  const std::uint32_t a = cell(row, column), b = cell(row, column + 1), c = cell(next, column + 1),
                      d = cell(next, column);
  const auto offer = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    if (p == q || q == r || r == p) return;
    if (flipped_) {
      visit(Triangle{p, r, q});
    } else {
      visit(Triangle{p, q, r});
    }
  };
  const bool ab = a != k_empty && b != k_empty && joined_in_profile(a, b);
  const bool dc = d != k_empty && c != k_empty && joined_in_profile(d, c);
  const bool ad = a != k_empty && d != k_empty && joined_across(a, d);
  const bool bc = b != k_empty && c != k_empty && joined_across(b, c);
  const bool ac = a != k_empty && c != k_empty && joined_across(a, c);
  const bool bd = b != k_empty && d != k_empty && joined_across(b, d);
  // All four: the shorter diagonal follows the surface; with one corner missing, the triangle that is left.
  const bool both = ac && bd;
  const bool prefer_ac =
      !both || (points_[a] - points_[c]).squaredNorm() <= (points_[b] - points_[d]).squaredNorm();
  if (ac && prefer_ac && ((ab && bc) || (dc && ad))) {
    if (ab && bc) offer(a, b, c);
    if (dc && ad) offer(a, c, d);
  } else if (bd) {
    if (ab && ad) offer(a, b, d);
    if (bc && dc) offer(b, c, d);
  }
}

}  // namespace biteline::transfer
