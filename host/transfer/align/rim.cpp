// SPDX-License-Identifier: MIT
#include "host/transfer/align/rim.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "host/geometry/robust.hpp"
#include "host/transfer/align/voxel_map.hpp"

namespace biteline::transfer {
namespace {

constexpr float k_clear_above_mm = 15;  // a seam or a glossy patch is no collar
constexpr float k_min_upright = 0.4F;   // a surface flatter than 66 degrees has no upper end
constexpr float k_half_slab_mm = 1;     // along the rim: one profile at 2 mm always falls into it
constexpr float k_off_surface_mm = 1;
constexpr float k_below_mm = 2;
constexpr float k_neighbour_mm = 6;  // rim's direction from points within it
constexpr std::size_t k_min_neighbours = 4;
// To each side.  What ends here is a piece of rim, where the view leaves it: its direction is not known, and
// a collar's rounded top is seen there from the side, some tenths too high.
constexpr float k_least_beside_mm = 2;
constexpr std::size_t k_min_points = 20;  // 4 cm

/// A surfel above which the surface does not go on.
struct Border {
  Eigen::Vector3f position, normal;
  Eigen::Vector3f up;                                    ///< unit, in the surface
  float highest_mm{-std::numeric_limits<float>::max()};  ///< of all points in line with it, along `up`
  float count{0};                                        ///< of those from k_below_mm under it upwards
  bool cut_by_view{false};  ///< the highest is the last one that the camera could see

  void offer(const Eigen::Vector3f& point, bool at_edge) {
    const Eigen::Vector3f d = point - position;
    if (std::abs(d.dot(normal)) > k_off_surface_mm || std::abs(d.dot(normal.cross(up))) > k_half_slab_mm)
      return;
    const float above_mm = d.dot(up);
    if (above_mm > highest_mm) {
      highest_mm = above_mm;
      cut_by_view = at_edge;
    }
    if (above_mm > -k_below_mm) count += 1;
  }
  [[nodiscard]] bool seen() const { return highest_mm > -k_clear_above_mm && !cut_by_view; }
  /// The highest of some points strewn up to an edge lies as far below it as they are apart.
  [[nodiscard]] Eigen::Vector3f end() const {
    const float apart_mm = count > 0 && highest_mm > -k_below_mm ? (highest_mm + k_below_mm) / count : 0;
    return position + (highest_mm + apart_mm) * up;
  }
};

template <class Visit>
void visit_cube(VoxelKey centre, Visit&& visit) {
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) visit(VoxelGrid::neighbour(centre, dx, dy, dz));
    }
  }
}

bool goes_on_above(const Eigen::Vector3f& position, const Eigen::Vector3f& up, const Surfels& surfels,
                   const VoxelGrid& grid, const VoxelMap& occupied) {
  for (float above_mm = surfels.pitch_mm; above_mm <= k_clear_above_mm; above_mm += surfels.pitch_mm) {
    bool found = false;
    visit_cube(grid.key(position + above_mm * up), [&](VoxelKey key) {
      const std::int64_t at = occupied.find(key);
      if (at < 0) return;
      found = found ||
              (surfels.positions[static_cast<std::size_t>(at)] - position).dot(up) > 0.5F * surfels.pitch_mm;
    });
    if (found) return true;
  }
  return false;
}

std::vector<Border> borders_of(const Surfels& surfels) {
  const VoxelGrid grid{surfels.pitch_mm};
  VoxelMap occupied;
  std::vector<std::uint32_t> holder;
  // Surfels of one pitch stand in different voxels, so numbers and indices agree.
  for (const Eigen::Vector3f& p : surfels.positions) occupied.number(grid.key(p));
  std::vector<Border> borders;
  if (occupied.size() != surfels.size()) return borders;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const Eigen::Vector3f& n = surfels.normals[i];
    const Eigen::Vector3f up = Eigen::Vector3f::UnitZ() - n.z() * n;
    if (up.norm() < k_min_upright) continue;
    const Border border{.position = surfels.positions[i], .normal = n, .up = up.normalized()};
    if (!goes_on_above(border.position, border.up, surfels, grid, occupied)) borders.push_back(border);
  }
  return borders;
}

/// The camera's outermost columns with anything in them.
class ViewEdges {
 public:
  explicit ViewEdges(const cloud::PointCloud& cloud) : column_{cloud.organised() ? &cloud.column : nullptr} {
    if (column_ == nullptr || column_->empty()) return;
    const auto [first, last] = std::minmax_element(column_->begin(), column_->end());
    first_ = *first;
    last_ = *last;
  }
  [[nodiscard]] bool at(std::size_t point) const {
    constexpr int k_columns = 2;
    return column_ != nullptr &&
           ((*column_)[point] <= first_ + k_columns || (*column_)[point] >= last_ - k_columns);
  }

 private:
  const std::vector<std::uint16_t>* column_;
  int first_{0}, last_{0};
};

/// Lets every point near a border take part in where that border ends.
void find_ends(const cloud::PointCloud& cloud, float pitch_mm, std::vector<Border>& borders) {
  const VoxelGrid grid{pitch_mm};
  VoxelMap voxels;
  std::vector<std::vector<std::uint32_t>> near;
  for (std::uint32_t i = 0; i < borders.size(); ++i) {
    visit_cube(grid.key(borders[i].position), [&](VoxelKey key) {
      const std::uint32_t at = voxels.number(key);
      if (at == near.size()) near.emplace_back();
      near[at].push_back(i);
    });
  }
  const ViewEdges edges{cloud};
  VoxelKey last_key = 0;
  std::int64_t last_at = -1;
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const Eigen::Vector3f& point = cloud.points[k];
    const VoxelKey key = grid.key(point);
    if (key != last_key) {
      last_key = key;
      last_at = voxels.find(key);
    }
    if (last_at < 0) continue;
    for (const std::uint32_t i : near[static_cast<std::size_t>(last_at)])
      borders[i].offer(point, edges.at(k));
  }
}

Eigen::Vector3f main_direction(const std::vector<Eigen::Vector3f>& ways) {
  Eigen::Matrix3f outer = Eigen::Matrix3f::Zero();
  for (const Eigen::Vector3f& way : ways) outer += way * way.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(outer / static_cast<float>(ways.size()));
  return solver.eigenvectors().col(2);
}

bool on_both_sides(const std::vector<Eigen::Vector3f>& ways, const Eigen::Vector3f& along) {
  float behind_mm = 0, ahead_mm = 0;
  for (const Eigen::Vector3f& way : ways) {
    behind_mm = std::max(behind_mm, -way.dot(along));
    ahead_mm = std::max(ahead_mm, way.dot(along));
  }
  return std::min(behind_mm, ahead_mm) >= k_least_beside_mm;
}

float median_along(const std::vector<Eigen::Vector3f>& ways, const Eigen::Vector3f& direction) {
  std::vector<float> heights;
  for (const Eigen::Vector3f& way : ways) heights.push_back(way.dot(direction));
  return geometry::median_of(std::span<float>{heights});
}

}  // namespace

Rim rim_of(const cloud::PointCloud& cloud, const Surfels& surfels) {
  std::vector<Border> borders = borders_of(surfels);
  find_ends(cloud, surfels.pitch_mm, borders);
  std::erase_if(borders, [](const Border& border) { return !border.seen(); });
  std::vector<Eigen::Vector3f> ends;
  for (const Border& border : borders) ends.push_back(border.end());

  Rim rim{.spacing_mm = surfels.pitch_mm};
  for (std::size_t i = 0; i < borders.size(); ++i) {
    std::vector<Eigen::Vector3f> ways;
    for (const Eigen::Vector3f& end : ends) {
      if ((end - ends[i]).squaredNorm() < k_neighbour_mm * k_neighbour_mm) ways.push_back(end - ends[i]);
    }
    if (ways.size() < k_min_neighbours) continue;
    const Eigen::Vector3f along = main_direction(ways), up = borders[i].up;
    if (!on_both_sides(ways, along)) continue;
    const Eigen::Vector3f across = (up - up.dot(along) * along).normalized();
    // One end is as uneven as its points are apart, and a stray point puts it too high: the rim is the middle
    // of those beside each other.
    rim.positions.push_back(ends[i] + median_along(ways, across) * across);
    rim.across.push_back(across);
  }
  if (rim.size() < k_min_points) return Rim{};
  return rim;
}

std::uint32_t nearest_on(const Rim& rim, const Eigen::Vector3f& point) {
  std::uint32_t best = 0;
  float best_squared = (rim.positions[0] - point).squaredNorm();
  for (std::uint32_t i = 1; i < rim.size(); ++i) {
    const float squared = (rim.positions[i] - point).squaredNorm();
    if (squared < best_squared) {
      best = i;
      best_squared = squared;
    }
  }
  return best;
}

}  // namespace biteline::transfer
