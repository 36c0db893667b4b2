// SPDX-License-Identifier: MIT
#include "host/transfer/carry/scan_mesh.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "host/geometry/robust.hpp"

namespace biteline::transfer {
namespace {

constexpr std::uint32_t k_empty = 0xFFFFFFFF;
constexpr std::size_t k_chunk = 32;       // columns: 2.5 mm of a profile
constexpr std::size_t k_group_rows = 16;  // row pairs: 18 mm of the way round

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

/// Line from -reach to +reach against a box; single precision, with a margin for its rounding.
class BoxTest {
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
        Box& around = groups_[group * chunks + chunk];
        around.low = around.low.min(box.low);
        around.high = around.high.max(box.high);
      }
    }
  });
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

std::optional<Hit> ScanMesh::cast(const Ray& ray) const {
  const std::size_t chunks = (width_ + k_chunk - 1) / k_chunk, pairs = row_pairs();
  const BoxTest test{ray};
  std::optional<Hit> best;
  const auto offer = [&](std::size_t row, std::size_t column, const Triangle& t) {
    const Vec3 a = points_[t[0]].cast<double>(), b = points_[t[1]].cast<double>(),
               c = points_[t[2]].cast<double>();
    const std::optional<double> distance_mm = crossing_mm(ray, a, b, c);
    if (!distance_mm || std::abs(*distance_mm) > (best ? std::abs(best->distance_mm) : ray.reach_mm)) return;
    const Vec3 normal = normal_at(row, column, t);
    if (normal.dot(ray.direction) < k_min_facing_cosine) return;
    best = Hit{
        .distance_mm = *distance_mm, .position = ray.origin + *distance_mm * ray.direction, .normal = normal};
  };
  for (std::size_t at = 0; at < groups_.size(); ++at) {
    if (!test.meets(groups_[at].low, groups_[at].high)) continue;
    const std::size_t first = at / chunks * k_group_rows, chunk = at % chunks;
    for (std::size_t row = first; row < std::min(pairs, first + k_group_rows); ++row) {
      const Box& box = chunks_[row * chunks + chunk];
      if (!test.meets(box.low, box.high)) continue;
      const std::size_t end = std::min(width_ - 1, (chunk + 1) * k_chunk);
      for (std::size_t column = chunk * k_chunk; column < end; ++column) {
        visit_quad(row, column, [&](const Triangle& t) { offer(row, column, t); });
      }
    }
  }
  return best;
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
