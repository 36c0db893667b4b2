// SPDX-License-Identifier: MIT
// Rays against the mesh of a scan.
#include <algorithm>
#include <array>
#include <cmath>

#include "host/transfer/carry/scan_mesh.hpp"

namespace biteline::transfer {
namespace {

/// Crossing of a ray with the triangle's plane inside the triangle (Moeller, Trumbore 1997), double
/// precision.
std::optional<double> crossing_mm(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = ray.direction.cross(ac);
  const double determinant = ab.dot(p);
  // Products of edges and a unit vector in mm²: below this the triangle is seen edge-on or has no area.
  constexpr double k_min_area_mm2 = 1e-9;
  if (std::abs(determinant) < k_min_area_mm2) return std::nullopt;
  const Vec3 s = ray.origin - a;
  const double u = s.dot(p) / determinant;
  // A ray through a shared edge must not slip between two triangles.
  constexpr double k_slack = 1e-9;
  if (u < -k_slack || u > 1 + k_slack) return std::nullopt;
  const Vec3 q = s.cross(ab);
  const double v = ray.direction.dot(q) / determinant;
  if (v < -k_slack || u + v > 1 + k_slack) return std::nullopt;
  return ac.dot(q) / determinant;
}

}  // namespace

/// From points some columns to both sides: columns are 0.08 mm apart, a triangle's own normal is mostly
/// noise.
Vec3 ScanMesh::normal_at(std::size_t row, std::size_t column, const Triangle& triangle) const {
  constexpr std::size_t k_half_columns = 6;
  const auto edge_normal = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) -> Vec3 {
    return (points_[b] - points_[a]).cross(points_[d] - points_[c]).cast<double>();
  };
  Vec3 normal = edge_normal(triangle[0], triangle[1], triangle[0], triangle[2]);
  const std::size_t next = row + 1 < rows_ ? row + 1 : 0;
  if (column >= k_half_columns && column + k_half_columns < width_) {
    const std::uint32_t below = cell(row, column - k_half_columns),
                        above = cell(row, column + k_half_columns);
    const std::uint32_t here = cell(row, column), beside = cell(next, column);
    const float reach_squared = 4 * k_half_columns * k_half_columns * step_squared_;
    if (below != k_empty && above != k_empty && here != k_empty && beside != k_empty &&
        joined_across(here, beside) && (points_[above] - points_[below]).squaredNorm() < reach_squared) {
      // Same turn as triangle (row, column), (row, column + 1), (next, ...): along the profile first, then
      // across.
      normal = flipped_ ? edge_normal(here, beside, below, above) : edge_normal(below, above, here, beside);
    }
  }
  return normal.normalized();
}

/// Line from -reach to +reach against a box; single precision, with a margin for its rounding.
class ScanMesh::BoxTest {
 public:
  explicit BoxTest(const Ray& ray)
      : middle_{ray.origin.cast<float>().array()},
        half_{(ray.direction * ray.reach_mm).cast<float>().array()} {}

  [[nodiscard]] bool meets(const Eigen::Array3f& low, const Eigen::Array3f& high) const {
    // Separating axes: the three of the box, then the three crossed with the segment (Ericson 2004, 5.3.3).
    constexpr float k_box_margin_mm = 1e-3F;
    const Eigen::Array3f extent = (high - low) / 2 + k_box_margin_mm;
    const Eigen::Array3f m = middle_ - (high + low) / 2;
    const Eigen::Array3f reach = half_.abs();
    if ((m.abs() > extent + reach).any()) return false;
    const Eigen::Vector3f cross = m.matrix().cross(half_.matrix());
    return std::abs(cross.x()) <= extent.y() * reach.z() + extent.z() * reach.y() + k_box_margin_mm &&
           std::abs(cross.y()) <= extent.x() * reach.z() + extent.z() * reach.x() + k_box_margin_mm &&
           std::abs(cross.z()) <= extent.x() * reach.y() + extent.y() * reach.x() + k_box_margin_mm;
  }

 private:
  Eigen::Array3f middle_, half_;
};

/// The ray seen along itself is a point: a triangle that it crosses lies to both sides of it, both ways.
class ScanMesh::Aside {
 public:
  explicit Aside(const Ray& ray) : origin_{ray.origin}, first_{ray.direction.unitOrthogonal()} {
    second_ = ray.direction.cross(first_);
  }

  /// Where the columns of a chunk lie, in two rows.
  void look(const ScanMesh& mesh, std::size_t row, std::size_t next, std::size_t begin, std::size_t end) {
    for (std::size_t k = 0; k <= end - begin; ++k) {
      Span& span = spans_[k];
      span = {};
      span.take(mesh, mesh.cell(row, begin + k), *this);
      span.take(mesh, mesh.cell(next, begin + k), *this);
    }
  }
  /// The quad between column `k` of the chunk and the next one.
  [[nodiscard]] bool may_hold(std::size_t k) const {
    const Eigen::Array2d low = spans_[k].low.min(spans_[k + 1].low),
                         high = spans_[k].high.max(spans_[k + 1].high);
    // What rounding leaves of a coordinate of some metres.
    constexpr double k_margin_mm = 1e-6;
    return (low <= k_margin_mm).all() && (high >= -k_margin_mm).all();
  }

 private:
  struct Span {
    Eigen::Array2d low{Eigen::Array2d::Constant(1e18)}, high{Eigen::Array2d::Constant(-1e18)};

    void take(const ScanMesh& mesh, std::uint32_t at, const Aside& aside) {
      if (at == k_empty) return;
      const Vec3 d = mesh.points_[at].cast<double>() - aside.origin_;
      const Eigen::Array2d place{aside.first_.dot(d), aside.second_.dot(d)};
      low = low.min(place);
      high = high.max(place);
    }
  };

  Vec3 origin_, first_, second_;
  std::array<Span, k_chunk + 1> spans_{};
};

std::optional<Hit> ScanMesh::cast(const Ray& ray) const {
  const BoxTest test{ray};
  Aside aside{ray};
  std::optional<Hit> best;
  for (std::size_t at = 0; at < blocks_.size(); ++at) {
    if (test.meets(blocks_[at].low, blocks_[at].high)) cast_in_block(ray, test, at, aside, best);
  }
  return best;
}

void ScanMesh::cast_in_block(const Ray& ray, const BoxTest& test, std::size_t block, Aside& aside,
                             std::optional<Hit>& best) const {
  const std::size_t chunks = (width_ + k_chunk - 1) / k_chunk, groups = groups_.size() / chunks;
  const std::size_t first_group = block / block_chunks_ * k_block,
                    first_chunk = block % block_chunks_ * k_block;
  for (std::size_t group = first_group; group < std::min(groups, first_group + k_block); ++group) {
    for (std::size_t chunk = first_chunk; chunk < std::min(chunks, first_chunk + k_block); ++chunk) {
      const Box& around = groups_[group * chunks + chunk];
      if (!test.meets(around.low, around.high)) continue;
      const std::size_t first = group * k_group_rows;
      for (std::size_t row = first; row < std::min(row_pairs(), first + k_group_rows); ++row) {
        const Box& box = chunks_[row * chunks + chunk];
        if (test.meets(box.low, box.high)) cast_in_chunk(ray, row, chunk, aside, best);
      }
    }
  }
}

void ScanMesh::cast_in_chunk(const Ray& ray, std::size_t row, std::size_t chunk, Aside& aside,
                             std::optional<Hit>& best) const {
  const std::size_t begin = chunk * k_chunk, end = std::min(width_ - 1, begin + k_chunk);
  if (begin >= end) return;
  aside.look(*this, row, row + 1 < rows_ ? row + 1 : 0, begin, end);
  for (std::size_t column = begin; column < end; ++column) {
    if (!aside.may_hold(column - begin)) continue;
    visit_quad(row, column, [&](const Triangle& t) {
      const Vec3 a = points_[t[0]].cast<double>(), b = points_[t[1]].cast<double>(),
                 c = points_[t[2]].cast<double>();
      const std::optional<double> distance_mm = crossing_mm(ray, a, b, c);
      if (!distance_mm || std::abs(*distance_mm) > (best ? std::abs(best->distance_mm) : ray.reach_mm))
        return;
      const Vec3 normal = normal_at(row, column, t);
      if (normal.dot(ray.direction) < k_min_facing_cosine) return;
      best = Hit{.distance_mm = *distance_mm,
                 .position = ray.origin + *distance_mm * ray.direction,
                 .normal = normal};
    });
  }
}

}  // namespace biteline::transfer
