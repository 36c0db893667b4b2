// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "common/core/numbers.hpp"

namespace biteline::path {
namespace {

using kinematics::Capsule;

// Spacing of the points that stand for the shoe.
constexpr double k_spacing_mm = 8;
// No arm here reaches farther down than this below the line.
constexpr double k_most_below_mm = 2000;
// An upper leans inwards at least this much, mm per mm of height; a line's normals at the crease tell only
// its beginning.
constexpr double k_least_lean = 0.15;

/// Thinned outline: every few points of the line.
std::vector<cloud::LinePoint> thinned(const cloud::ClosedLine& line, double spacing_mm) {
  std::vector<cloud::LinePoint> out;
  for (const cloud::LinePoint& p : line.points) {
    if (out.empty() || (p.position - out.back().position).norm() >= spacing_mm) out.push_back(p);
  }
  return out;
}

/// Points of a grid inside the outline (even-odd rule), at the outline's mean height.
std::vector<Vec3> inside(const std::vector<Vec3>& outline, double spacing_mm) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : outline) box.extend(p);
  const double z_mm = 0.5 * (box.min().z() + box.max().z());
  std::vector<Vec3> out;
  for (double y = box.min().y() + spacing_mm / 2; y < box.max().y(); y += spacing_mm) {
    for (double x = box.min().x() + spacing_mm / 2; x < box.max().x(); x += spacing_mm) {
      bool in = false;
      for (std::size_t i = 0, k = outline.size() - 1; i < outline.size(); k = i++) {
        const Vec3& a = outline[i];
        const Vec3& b = outline[k];
        if ((a.y() > y) != (b.y() > y) && x < (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()) + a.x())
          in = !in;
      }
      if (in) out.emplace_back(x, y, z_mm);
    }
  }
  return out;
}

}  // namespace

Surroundings surroundings_of_line(const cloud::ClosedLine& line, const ShoeGuess& guess, double table_z_mm) {
  Surroundings out{.table_z_mm = table_z_mm, .shoe_points = {}, .shoe_spacing_mm = k_spacing_mm};
  const std::vector<cloud::LinePoint> outline = thinned(line, k_spacing_mm);
  std::vector<Vec3> top;
  for (const cloud::LinePoint& p : outline) {
    const Vec3 level = Vec3{p.normal.x(), p.normal.y(), 0}.normalized();
    // Whatever a shoe may stand on; and bounded, wherever the table is said to be.
    const double foot_mm = std::max(table_z_mm, p.position.z() - k_most_below_mm);
    for (double z_mm = foot_mm; z_mm < p.position.z(); z_mm += k_spacing_mm) {
      const Vec3 wall = p.position + guess.overhang_mm * level;
      out.shoe_points.emplace_back(wall.x(), wall.y(), z_mm);
    }
    const double lean = std::max(k_least_lean, p.normal.z() / std::max(0.2, p.normal.head<2>().norm()));
    for (double h_mm = 0; h_mm <= guess.height_mm; h_mm += k_spacing_mm) {
      const Vec3 wall = p.position - lean * h_mm * level;
      out.shoe_points.emplace_back(wall.x(), wall.y(), p.position.z() + h_mm);
    }
    top.emplace_back(p.position - k_least_lean * guess.height_mm * level + guess.height_mm * Vec3::UnitZ());
  }
  const std::vector<Vec3> lid = inside(top, k_spacing_mm);
  out.shoe_points.insert(out.shoe_points.end(), lid.begin(), lid.end());
  return out;
}

void replace_shoe(Surroundings& surroundings, const std::vector<Eigen::Vector3f>& cloud_base) {
  constexpr float k_above_table_mm = 3;
  // Points of a scan follow each other closely: most are in the cell of the one before.
  std::map<std::tuple<int, int, int>, Vec3> cells;
  std::tuple<int, int, int> last{};
  const auto cell = [](float mm) { return static_cast<int>(std::floor(mm / (k_spacing_mm / 2))); };
  for (const Eigen::Vector3f& p : cloud_base) {
    if (p.z() < static_cast<float>(surroundings.table_z_mm) + k_above_table_mm) continue;
    const std::tuple key{cell(p.x()), cell(p.y()), cell(p.z())};
    if (key == last && !cells.empty()) continue;
    cells.try_emplace(key, p.cast<double>());
    last = key;
  }
  surroundings.shoe_points.clear();
  for (const auto& [key, point] : cells) surroundings.shoe_points.push_back(point);
}

double distance_mm(const Capsule& a, const Capsule& b) {
  // Ericson 2005, "Real-Time Collision Detection", 5.1.9: closest points of two segments.
  const Vec3 d1 = a.b - a.a, d2 = b.b - b.a, r = a.a - b.a;
  const double l1 = d1.squaredNorm(), l2 = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), g = d1.dot(d2);
  const double denominator = l1 * l2 - g * g;
  double s = denominator > 1e-9 * l1 * l2 && denominator > 0
                 ? std::clamp((g * f - c * l2) / denominator, 0.0, 1.0)
                 : 0.0;
  double t = l2 > 0 ? (g * s + f) / l2 : 0.0;
  if (t < 0 || t > 1 || l2 <= 0) {
    t = std::clamp(t, 0.0, 1.0);
    s = l1 > 0 ? std::clamp((g * t - c) / l1, 0.0, 1.0) : 0.0;
  }
  return (a.a + s * d1 - b.a - t * d2).norm() - a.radius_mm - b.radius_mm;
}

CollisionModel::CollisionModel(const kinematics::ArmModel& arm, const Tool& tool, Surroundings surroundings)
    : links_{kinematics::link_capsules(arm)},
      surroundings_{std::move(surroundings)},
      shoe_{surroundings_.shoe_points} {
  const Vec3 tip = tool.T_flange_tcp.translation();
  const Vec3 end = tip - tool.contact_length_mm * tool.T_flange_tcp.linear().col(2);
  tool_flange_ = {.a = Vec3::Zero(), .b = end, .radius_mm = tool.body_radius_mm};
  // The capsule's round end must not reach past the body's end: shorten it by the radius where it is long
  // enough.
  const double length_mm = end.norm();
  if (length_mm > tool.body_radius_mm) tool_flange_.b = end * ((length_mm - tool.body_radius_mm) / length_mm);
  tip_flange_ = {.a = end, .b = tip, .radius_mm = 0};
  for (const Vec3& p : surroundings_.shoe_points) shoe_box_.extend(p);
}

Clearance CollisionModel::tip_clearance(const SE3& T_base_flange, double enough_mm) const {
  const Capsule tip{.a = T_base_flange * tip_flange_.a, .b = T_base_flange * tip_flange_.b, .radius_mm = 0};
  return {.mm = to_shoe_mm(tip, enough_mm), .what = "tool's tip and shoe"};
}

double CollisionModel::to_shoe_mm(const Capsule& capsule, double enough_mm) const {
  if (surroundings_.shoe_points.empty()) return enough_mm;
  Eigen::AlignedBox3d box{capsule.a.cwiseMin(capsule.b), capsule.a.cwiseMax(capsule.b)};
  const double margin_mm = capsule.radius_mm + enough_mm + 0.5 * surroundings_.shoe_spacing_mm;
  box.min().array() -= margin_mm;
  box.max().array() += margin_mm;
  if (!box.intersects(shoe_box_)) return enough_mm;
  const double gap_mm =
      0.5 * surroundings_.shoe_spacing_mm;  // the surface may be that much nearer between the points
  return shoe_.nearest_mm(capsule, enough_mm + gap_mm) - gap_mm;
}

Clearance CollisionModel::clearance(const std::array<SE3, kinematics::k_joints>& T_base_joint,
                                    double enough_mm) const {
  const auto links = kinematics::placed(links_, T_base_joint);
  const SE3& T_base_flange = T_base_joint.back();
  const Capsule tool{.a = T_base_flange * tool_flange_.a,
                     .b = T_base_flange * tool_flange_.b,
                     .radius_mm = tool_flange_.radius_mm};
  Clearance best{.mm = enough_mm, .what = ""};
  const auto take = [&](double mm, const char* what) {
    // A distance that is no number is none that anyone may rely on.
    if (!(mm >= best.mm)) best = {.mm = std::isnan(mm) ? -k_far_mm : mm, .what = what};
  };
  const auto to_table_mm = [&](const Capsule& c) {
    // Both ends, since min() may drop the one that is no number.
    const double a_mm = c.a.z() - c.radius_mm - surroundings_.table_z_mm;
    const double b_mm = c.b.z() - c.radius_mm - surroundings_.table_z_mm;
    return std::isnan(a_mm + b_mm) ? a_mm + b_mm : std::min(a_mm, b_mm);
  };

  take(to_table_mm(tool), "tool and table");
  take(to_shoe_mm(tool, best.mm), "tool and shoe");
  for (std::size_t i = 2; i < links.size(); ++i) {
    take(to_table_mm(links[i]), "arm and table");
    if (i >= 3) take(to_shoe_mm(links[i], best.mm), "arm and shoe");
  }
  // Neighbours of the chain touch by construction; the forearm cannot reach the wrists' far side.
  for (const std::size_t fixed : {0U, 1U, 2U}) {
    take(distance_mm(tool, links[fixed]), "tool and arm");
    for (const std::size_t moving : {6U, 7U}) take(distance_mm(links[moving], links[fixed]), "wrist and arm");
  }
  take(distance_mm(tool, links[4]), "tool and forearm");
  return best;
}

}  // namespace biteline::path
