// SPDX-License-Identifier: MIT
#include "host/bite_line/shoe/shoe.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include <tbb/blocked_range.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include "common/core/fixed_text.hpp"
#include "host/bite_line/buckets.hpp"
#include "host/bite_line/shoe/cells.hpp"
#include "host/bite_line/shoe/plan.hpp"

namespace biteline::bite_line {

namespace {

constexpr double k_max_tilt_rad = 12.0 * std::numbers::pi / 180.0;
// Soles of 90 to 350 mm, and the margin that a flared sole and noise need.
constexpr double k_min_length_mm = 85.0;
constexpr double k_max_length_mm = 360.0;
constexpr double k_min_width_to_length = 0.22;
constexpr double k_max_width_to_length = 0.62;
constexpr std::size_t k_min_points = 2000;

struct Plane {
  Vec3 normal{Vec3::UnitZ()};
  double offset_mm{0};  ///< normal . p = offset

  [[nodiscard]] double height_mm(const Vec3& p) const { return normal.dot(p) - offset_mm; }
};

Plane plane_through(const Vec3& a, const Vec3& b, const Vec3& c) {
  Vec3 normal = (b - a).cross(c - a);
  const double norm = normal.norm();
  if (norm < 1e-9) return {.normal = Vec3::UnitX(), .offset_mm = 0};
  normal /= normal.z() < 0 ? -norm : norm;
  return {.normal = normal, .offset_mm = normal.dot(a)};
}

/// Least squares of z on x and y over points with weights; the planes here are nearly level.
Plane fit_level_plane(std::span<const Vec3> points, std::span<const double> weights) {
  Mat3 A = Mat3::Identity() * 1e-9;
  Vec3 b = Vec3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 row{points[i].x(), points[i].y(), 1.0};
    A += weights[i] * row * row.transpose();
    b += weights[i] * points[i].z() * row;
  }
  const Vec3 x = A.ldlt().solve(b);
  const Vec3 normal = Vec3{-x[0], -x[1], 1.0}.normalized();
  return {.normal = normal, .offset_mm = x[2] * normal.z()};
}

/// A wide, nearly level plane with hardly anything below it: a table.  RANSAC over the cells' means.
std::optional<Plane> find_table(const Cells& cells) {
  constexpr double k_thickness_mm = 1.5;
  // Two and a half soles: the bottom of a shoe itself, or the tread, is no table.
  constexpr double k_min_area_mm2 = 50'000.0;
  constexpr double k_max_share_below = 0.03;
  constexpr int k_draws = 300;
  const double cell_area = static_cast<double>(cells.cell_mm()) * static_cast<double>(cells.cell_mm());
  if (static_cast<double>(cells.means().size()) * cell_area < k_min_area_mm2) return std::nullopt;

  std::vector<Vec3> means;
  means.reserve(cells.means().size());
  for (const Eigen::Vector3f& mean : cells.means()) means.push_back(mean.cast<double>());
  std::mt19937 random{17};
  std::uniform_int_distribution<std::size_t> draw{0, means.size() - 1};
  const std::size_t step = std::max<std::size_t>(1, means.size() / 4000);
  Plane best;
  std::size_t best_inliers = 0;
  for (int k = 0; k < k_draws; ++k) {
    const Plane plane = plane_through(means[draw(random)], means[draw(random)], means[draw(random)]);
    if (plane.normal.z() < std::cos(k_max_tilt_rad)) continue;
    std::size_t inliers = 0;
    for (std::size_t i = 0; i < means.size(); i += step)
      inliers += std::abs(plane.height_mm(means[i])) < k_thickness_mm ? 1U : 0U;
    if (inliers <= best_inliers) continue;
    best_inliers = inliers;
    best = plane;
  }
  if (static_cast<double>(best_inliers * step) * cell_area < k_min_area_mm2) return std::nullopt;

  std::vector<Vec3> on_plane;
  for (int round = 0; round < 3; ++round) {
    on_plane.clear();
    for (const Vec3& p : means) {
      if (std::abs(best.height_mm(p)) < k_thickness_mm) on_plane.push_back(p);
    }
    best = fit_level_plane(on_plane, std::vector<double>(on_plane.size(), 1.0));
  }
  const auto below = static_cast<double>(std::count_if(
      means.begin(), means.end(), [&](const Vec3& p) { return best.height_mm(p) < -2 * k_thickness_mm; }));
  if (below > k_max_share_below * static_cast<double>(means.size())) return std::nullopt;
  return best;
}

/// Cells with fewer points tell nothing of the shoe's size, nor of what is connected: strays that lie in a
/// row would lengthen it, and in a cloud of many points join it to everything around.  A twentieth of the
/// points of the cell in which the median point lies, but surface that is seen with one point on 2 mm^2
/// counts.
double fewest_points(const Cells& cells, std::size_t points) {
  constexpr double k_share = 0.05;
  constexpr double k_points_per_mm2 = 0.5;
  std::vector<std::uint32_t> counts{cells.counts().begin(), cells.counts().end()};
  if (counts.empty()) return 0;
  std::sort(counts.begin(), counts.end());
  std::size_t median = 0;
  for (std::size_t so_far = counts[0]; 2 * so_far < points && median + 1 < counts.size();)
    so_far += counts[++median];
  const auto cell_mm = static_cast<double>(cells.cell_mm());
  return std::min(k_share * static_cast<double>(counts[median]), k_points_per_mm2 * cell_mm * cell_mm);
}

/// Of one connected component, seen from above.
std::vector<Vec2> hull_of(const Cells& cells, const std::vector<std::int32_t>& labels, int label) {
  std::vector<Vec2> points;
  for (std::size_t slot = 0; slot < labels.size(); ++slot) {
    if (labels[slot] == label) points.push_back(cells.means()[slot].head<2>().cast<double>());
  }
  return convex_hull(std::move(points));
}

bool shoe_sized(const PlanBox& box) {
  const double ratio = box.width_mm / std::max(box.length_mm, 1.0);
  return box.length_mm >= k_min_length_mm && box.length_mm <= k_max_length_mm &&
         ratio >= k_min_width_to_length && ratio <= k_max_width_to_length;
}

/// Components that may be one shoe, and their outline together.
struct Parts {
  std::vector<int> labels;
  std::vector<Vec2> hull;
};

/// The component `first`, and others that complete it (a band cut twice by missing sectors) as long as the
/// whole stays shoe-sized and they lie within reach.
Parts parts_about(int first, std::span<const int> others, const Cells& cells,
                  const std::vector<std::int32_t>& labels) {
  Parts parts{.labels = {first}, .hull = hull_of(cells, labels, first)};
  for (const int other : others) {
    if (other == first || parts.hull.size() < 3) continue;
    const std::vector<Vec2> part = hull_of(cells, labels, other);
    std::vector<Vec2> joined = parts.hull;
    joined.insert(joined.end(), part.begin(), part.end());
    joined = convex_hull(std::move(joined));
    const PlanBox before = tightest_box(parts.hull);
    const PlanBox after = tightest_box(joined);
    const bool inside = after.length_mm < before.length_mm + 8 && after.width_mm < before.width_mm + 8;
    if (!inside && (shoe_sized(before) || !shoe_sized(after))) continue;
    parts.labels.push_back(other);
    parts.hull = std::move(joined);
  }
  return parts;
}

/// Marks the components that make up the shoe: about the one that is a shoe's size by itself, or else about
/// the largest that comes to that with others.  A clamp's column may be larger than the shoe.
std::vector<bool> choose_components(const Cells& cells, const std::vector<std::int32_t>& labels,
                                    int components) {
  constexpr double k_min_share = 0.04;   // of the largest: smaller ones are specks
  constexpr double k_rival_share = 0.5;  // of the largest: smaller ones are parts of it
  constexpr std::size_t k_most_parts = 12;
  std::vector<std::size_t> size(static_cast<std::size_t>(components), 0);
  for (const std::int32_t label : labels) {
    if (label >= 0) ++size[static_cast<std::size_t>(label)];
  }
  std::vector<int> order(static_cast<std::size_t>(components));
  for (int i = 0; i < components; ++i) order[static_cast<std::size_t>(i)] = i;
  const auto size_of = [&](int label) { return size[static_cast<std::size_t>(label)]; };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return size_of(a) > size_of(b); });

  std::vector<bool> chosen(static_cast<std::size_t>(components), false);
  if (order.empty()) return chosen;
  const int largest = order[0];
  const auto share_of = [&](int label) {
    return static_cast<double>(size_of(label)) / static_cast<double>(size_of(largest));
  };
  order.resize(std::min(order.size(), k_most_parts));
  std::erase_if(order, [&](int label) { return share_of(label) < k_min_share; });
  const auto is_sized = [](const std::vector<Vec2>& hull) {
    return hull.size() >= 3 && shoe_sized(tightest_box(hull));
  };
  std::vector<int> about = order;
  const auto by_itself = std::find_if(about.begin(), about.end(), [&](int label) {
    return share_of(label) >= k_rival_share && is_sized(hull_of(cells, labels, label));
  });
  if (by_itself != about.end()) std::rotate(about.begin(), by_itself, by_itself + 1);
  Parts shoe;
  for (std::size_t k = 0; k < about.size() && !is_sized(shoe.hull); ++k) {
    Parts parts = parts_about(about[k], order, cells, labels);
    if (k == 0 || is_sized(parts.hull)) shoe = std::move(parts);
  }
  for (const int label : shoe.labels) chosen[static_cast<std::size_t>(label)] = true;
  return chosen;
}

/// The rim: lowest point of each stretch of the plan from the heel to behind the toe spring.  On a sole it is
/// a plane.
std::optional<Plane> find_rim(std::span<const Vec3> points_shoe, double length_mm) {
  constexpr std::size_t k_stretches = 30;
  constexpr double k_inlier_mm = 1.2;
  struct Lowest {
    double z{1e9};
    Vec3 point{Vec3::Zero()};
  };
  // Two rows of stretches along x, one per side; 8 % to 62 % of the length leaves out the heel's bevel and
  // the toe spring.
  std::vector<Lowest> lowest(2 * k_stretches);
  for (const Vec3& p : points_shoe) {
    const double share = (p.x() / length_mm - 0.08) / 0.54;
    if (share < 0 || share >= 1) continue;
    Lowest& place =
        lowest[static_cast<std::size_t>(share * static_cast<double>(k_stretches)) * 2 + (p.y() > 0 ? 1 : 0)];
    if (p.z() < place.z) place = {p.z(), p};
  }
  std::vector<Vec3> rim;
  for (const Lowest& place : lowest) {
    if (place.z < 1e8) rim.push_back(place.point);
  }
  if (rim.size() < k_stretches) return std::nullopt;
  std::vector<double> weights(rim.size(), 1.0);
  Plane plane;
  for (int round = 0; round < 12; ++round) {
    plane = fit_level_plane(rim, weights);
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const double r = plane.height_mm(rim[i]) / k_inlier_mm;
      weights[i] = 1.0 / (1.0 + r * r * r * r);
    }
  }
  const auto inliers = std::count_if(
      rim.begin(), rim.end(), [&](const Vec3& p) { return std::abs(plane.height_mm(p)) < k_inlier_mm; });
  // A shoe stands on its rim.  What a heel block stands out below is a shank.
  const auto below = std::count_if(rim.begin(), rim.end(),
                                   [&](const Vec3& p) { return plane.height_mm(p) < -2 * k_inlier_mm; });
  if (static_cast<double>(inliers) < 0.6 * static_cast<double>(rim.size()) ||
      static_cast<double>(below) > 0.1 * static_cast<double>(rim.size()) ||
      plane.normal.z() < std::cos(k_max_tilt_rad))
    return std::nullopt;
  return plane;
}

/// Axes from the plan: long side, turned so that the wider forefoot is in front.
SE3 axes_from_plan(std::span<const Vec3> points_up, const Mat3& R_base_up, PlanBox& box) {
  std::vector<Vec2> plan;
  plan.reserve(points_up.size());
  double lowest = 1e9;
  for (const Vec3& p : points_up) {
    plan.push_back(p.head<2>());
    lowest = std::min(lowest, p.z());
  }
  const std::vector<Vec2> hull = convex_hull(std::move(plan));
  if (hull.size() < 3) return SE3::Identity();
  box = tightest_box(hull);
  Vec2 forward = box.long_axis;
  if ((box.area_centroid - box.centre).dot(forward) < 0) forward = -forward;
  const Vec2 left{-forward.y(), forward.x()};
  const Vec2 heel = box.centre - 0.5 * box.length_mm * forward;
  Mat3 R_up_shoe;
  R_up_shoe << forward.x(), left.x(), 0, forward.y(), left.y(), 0, 0, 0, 1;
  SE3 T_base_shoe = SE3::Identity();
  T_base_shoe.linear() = R_base_up * R_up_shoe;
  T_base_shoe.translation() = R_base_up * Vec3{heel.x(), heel.y(), lowest};
  return T_base_shoe;
}

/// Upright axes: z is up from the table, or else from the rim, which the axes from before it show.
SE3 stand_up(std::span<const Vec3> means, std::span<const Vec3> means_to_the_rim,
             const std::optional<Plane>& table, PlanBox& box) {
  constexpr int k_rounds = 3;
  Mat3 R_base_up = Mat3::Identity();
  if (table) R_base_up = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), table->normal).toRotationMatrix();
  for (int round = 1;; ++round) {
    std::vector<Vec3> up{means.begin(), means.end()};
    for (Vec3& p : up) p = R_base_up.transpose() * p;
    const SE3 T_base_shoe = axes_from_plan(up, R_base_up, box);
    if (!shoe_sized(box) || round == k_rounds) return T_base_shoe;
    std::vector<Vec3> in_shoe{means_to_the_rim.begin(), means_to_the_rim.end()};
    const SE3 T_shoe_base = T_base_shoe.inverse();
    for (Vec3& p : in_shoe) p = T_shoe_base * p;
    const std::optional<Plane> rim = find_rim(in_shoe, box.length_mm);
    if (!rim) return T_base_shoe;
    const Vec3 up_base = T_base_shoe.linear() * rim->normal;
    if (up_base.z() < std::cos(k_max_tilt_rad)) return T_base_shoe;
    R_base_up = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), up_base).toRotationMatrix();
  }
}

}  // namespace

OrRefusal<Shoe> find_shoe(std::span<const Eigen::Vector3f> points_base) {
  Shoe shoe;
  if (points_base.size() < k_min_points) return refuse(Refused::TooFewPoints, "not a shoe: too few points");

  const Cells cells{points_base, {}};
  std::optional<Plane> table;
  double fewest = 0;
  tbb::parallel_invoke([&] { table = find_table(cells); },
                       [&] { fewest = fewest_points(cells, points_base.size()); });
  std::vector<bool> keep(cells.occupied().size()), few(keep.size());
  for (std::size_t slot = 0; slot < keep.size(); ++slot) {
    // A cell's mean may be above the table although points of it are on it; those are dropped one by one
    // below.
    keep[slot] = !table || table->height_mm(cells.means()[slot].cast<double>()) > 1.5;
    few[slot] = keep[slot] && static_cast<double>(cells.counts()[slot]) < fewest;
    keep[slot] = keep[slot] && !few[slot];
  }
  std::vector<std::int32_t> labels;
  const int components = cells.label(keep, labels);
  const std::vector<bool> chosen = choose_components(cells, labels, components);
  const auto is_chosen = [&](std::size_t slot) {
    return labels[slot] >= 0 && chosen[static_cast<std::size_t>(labels[slot])];
  };
  enum OfShoe : std::uint8_t { k_none = 0, k_chosen, k_beside };
  std::vector<std::uint8_t> parts(labels.size(), k_none);
  std::vector<Vec3> means, means_to_the_rim;
  for (std::size_t slot = 0; slot < labels.size(); ++slot) {
    if (is_chosen(slot)) {
      parts[slot] = k_chosen;
    } else if (few[slot]) {
      // A cell whose corner alone the surface cuts has few points, too.
      cells.around(slot, [&](std::size_t other) {
        if (is_chosen(other)) parts[slot] = k_beside;
      });
    }
    if (parts[slot] == k_none) continue;
    const Vec3 mean = cells.means()[slot].cast<double>();
    if (parts[slot] == k_chosen) means.push_back(mean);
    means_to_the_rim.push_back(mean);
  }
  if (means.size() < 200)
    return refuse(Refused::NothingConnected, "not a shoe: nothing connected of a shoe's size");

  PlanBox box;
  PooledVector<std::uint8_t> part_of_cell;
  const auto part = [&](std::size_t i) {
    const std::int32_t cell = cells.cell_of(i);
    return cell < 0 ? k_none : static_cast<OfShoe>(part_of_cell[static_cast<std::size_t>(cell)]);
  };
  tbb::parallel_invoke([&] { shoe.T_base_shoe = stand_up(means, means_to_the_rim, table, box); },
                       [&] {
                         part_of_cell = cells.by_cell(parts);
                         shoe.index = items_where(points_base.size(), [&](std::size_t i) {
                           return part(i) != k_none &&
                                  !(table && table->height_mm(points_base[i].cast<double>()) < 1.0);
                         });
                       });
  shoe.length_mm = box.length_mm;
  shoe.width_mm = box.width_mm;
  if (!shoe_sized(box)) {
    return refuse(Refused::NotShoeSized,
                  FixedText<160>::format("not a shoe: what was seen is %.0f mm long and %.0f mm wide",
                                         box.length_mm, box.width_mm)
                      .c_str());
  }

  const Eigen::Isometry3f T_shoe_base = shoe.T_base_shoe.inverse().cast<float>();
  shoe.points.resize(shoe.index.size());
  shoe.alone.resize(shoe.index.size());
  shoe.box = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>{0, shoe.index.size(), 8192}, Eigen::AlignedBox3f{},
      [&](const auto& range, Eigen::AlignedBox3f box_seen) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          shoe.points[i] = T_shoe_base * points_base[shoe.index[i]];
          shoe.alone[i] = part(shoe.index[i]) == k_beside ? 1 : 0;
          box_seen.extend(shoe.points[i]);
        }
        return box_seen;
      },
      [](const Eigen::AlignedBox3f& a, const Eigen::AlignedBox3f& b) { return a.merged(b); });
  return shoe;
}

}  // namespace biteline::bite_line
