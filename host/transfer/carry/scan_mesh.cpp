// SPDX-License-Identifier: MIT
#include "host/transfer/carry/scan_mesh.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "host/geometry/robust.hpp"

namespace biteline::transfer {
namespace {

/// 256 MB: 30 000 profiles of 2048 columns.  In a spoiled file each point may be a profile of its own.
constexpr std::size_t k_most_cells = 64'000'000;

}  // namespace

Result<ScanMesh> ScanMesh::create(const cloud::PointCloud& cloud, const Limits& limits) {
  if (!cloud.organised())
    return fail(Errc::InvalidArgument, "a mesh of a scan needs each point's profile and column");
  ScanMesh mesh;
  BITELINE_TRY(mesh.lay_out(cloud, limits));
  if (mesh.rows_ < 2) return fail(Errc::Refused, "a surface needs at least 2 profiles");
  mesh.measure(limits);
  mesh.bound();
  mesh.turn_outward();
  return mesh;
}

/// Points into rows and columns; a gap of up to `max_column_gap` columns is closed by repeating the point
/// beside it, which makes triangles without area there and one wide one over the gap.  What lies away from
/// both its neighbours in the profile is left out: no triangle holds it, but a box that it stretched across
/// the scene would meet every ray.
Result<void> ScanMesh::lay_out(const cloud::PointCloud& cloud, const Limits& limits) {
  points_ = cloud.points;
  const auto [first, last] = std::minmax_element(cloud.column.begin(), cloud.column.end());
  if (cloud.size() == 0) return {};
  const std::size_t first_column = *first;
  width_ = std::size_t{*last} - first_column + 1;
  step_squared_ = static_cast<float>(limits.max_step_mm * limits.max_step_mm);
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i == 0 || cloud.profile[i] != cloud.profile[i - 1]) begins.push_back(i);
  }
  rows_ = begins.size();
  begins.push_back(cloud.size());
  if (rows_ > k_most_cells / width_) {
    return fail(Errc::BadValue,
                "a cloud of %zu profiles of %zu columns: no scan has so many (at most %zu cells)", rows_,
                width_, k_most_cells);
  }
  cells_.assign(rows_ * width_, k_empty);
  tbb::parallel_for(std::size_t{0}, rows_, [&](std::size_t row) {
    std::uint32_t* cells = cells_.data() + row * width_;
    std::size_t filled = 0;  // columns before it are done
    bool near_last = false;
    for (std::size_t i = begins[row]; i < begins[row + 1]; ++i) {
      const bool near_next = i + 1 < begins[row + 1] && joined_in_profile(static_cast<std::uint32_t>(i),
                                                                          static_cast<std::uint32_t>(i + 1));
      const bool stray = !near_last && !near_next;
      near_last = near_next;
      if (stray) continue;
      const std::size_t column = cloud.column[i] - first_column;
      const bool fill = filled > 0 && column <= filled + static_cast<std::size_t>(limits.max_column_gap);
      for (std::size_t at = fill ? filled : column; at <= column; ++at)
        cells[at] = static_cast<std::uint32_t>(i);
      filled = column + 1;
    }
  });
  return {};
}

/// The usual distance of two profiles, from cells spread over the scan, and whether the last one meets the
/// first.
void ScanMesh::measure(const Limits& limits) {
  const auto distances = [&](std::size_t row, std::size_t next, std::size_t column_step) {
    std::vector<float> found;
    for (std::size_t column = 0; column < width_; column += column_step) {
      const std::uint32_t a = cell(row, column), b = cell(next, column);
      if (a != k_empty && b != k_empty) found.push_back((points_[a] - points_[b]).norm());
    }
    return found;
  };
  std::vector<float> all;
  for (std::size_t row = 0; row + 1 < rows_; ++row) {
    const std::vector<float> some = distances(row, row + 1, 16);
    all.insert(all.end(), some.begin(), some.end());
  }
  const float usual_mm = all.empty() ? 0 : geometry::median_of(std::span<float>{all});
  const float gap_mm = static_cast<float>(limits.max_profile_gap_ratio) * usual_mm;
  gap_squared_ = gap_mm * gap_mm;
  std::vector<float> seam = distances(rows_ - 1, 0, 4);
  closed_ = rows_ > 2 && !seam.empty() && geometry::median_of(std::span<float>{seam}) < gap_mm;
}

bool ScanMesh::joined_in_profile(std::uint32_t a, std::uint32_t b) const {
  return (points_[a] - points_[b]).squaredNorm() <= step_squared_;
}

bool ScanMesh::joined_across(std::uint32_t a, std::uint32_t b) const {
  return (points_[a] - points_[b]).squaredNorm() <= gap_squared_;
}

void ScanMesh::bound() {
  const std::size_t chunks = (width_ + k_chunk - 1) / k_chunk, pairs = row_pairs();
  const std::size_t groups = (pairs + k_group_rows - 1) / k_group_rows;
  constexpr float k_far = 1e18F;  // mm; its square is still a float
  const Box nothing{Eigen::Array3f::Constant(k_far), Eigen::Array3f::Constant(-k_far)};
  chunks_.assign(pairs * chunks, nothing);
  groups_.assign(groups * chunks, nothing);
  tbb::parallel_for(std::size_t{0}, groups, [&](std::size_t group) {
    for (std::size_t row = group * k_group_rows; row < std::min(pairs, (group + 1) * k_group_rows); ++row) {
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        Box& box = chunks_[row * chunks + chunk];
        // One column more: the last quad reaches into the next chunk.
        const std::size_t end = std::min(width_, (chunk + 1) * k_chunk + 1);
        for (const std::size_t r : {row, row + 1 < rows_ ? row + 1 : 0}) {
          for (std::size_t column = chunk * k_chunk; column < end; ++column) {
            const std::uint32_t at = cell(r, column);
            if (at == k_empty) continue;
            box.low = box.low.min(points_[at].array());
            box.high = box.high.max(points_[at].array());
          }
        }
        groups_[group * chunks + chunk].take(box);
      }
    }
  });
  block_chunks_ = (chunks + k_block - 1) / k_block;
  blocks_.assign((groups + k_block - 1) / k_block * block_chunks_, nothing);
  for (std::size_t group = 0; group < groups; ++group) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk)
      blocks_[group / k_block * block_chunks_ + chunk / k_block].take(groups_[group * chunks + chunk]);
  }
}

/// Outward: away from the scan's middle, seen from above, for most of a sample of triangles.
void ScanMesh::turn_outward() {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : points_) mean += p / static_cast<float>(points_.size());
  float votes = 0;
  for (std::size_t row = 0; row < row_pairs(); row += 4) {
    for (std::size_t column = 0; column + 1 < width_; column += 16) {
      visit_quad(row, column, [&](const Triangle& t) {
        const Eigen::Vector3f n = (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]);
        votes += n.head<2>().dot((points_[t[0]] - mean).head<2>());
      });
    }
  }
  flipped_ = votes < 0;
}

std::vector<ScanMesh::Triangle> ScanMesh::triangles() const {
  std::vector<Triangle> all;
  all.reserve(2 * points_.size());
  for (std::size_t row = 0; row < row_pairs(); ++row) {
    for (std::size_t column = 0; column + 1 < width_; ++column) {
      visit_quad(row, column, [&](const Triangle& t) { all.push_back(t); });
    }
  }
  return all;
}

}  // namespace biteline::transfer
