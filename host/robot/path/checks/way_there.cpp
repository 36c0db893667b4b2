// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/way_there.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/robot/kinematics/chain.hpp"
#include "host/robot/kinematics/inverse.hpp"

namespace biteline::path {
namespace {

using kinematics::Joints;

constexpr double k_clearance_mm = 5;  // nobody has looked at this way: more than on the path itself
constexpr double k_enough_mm = 50;
constexpr double k_leaving_mm = 0.5;  // on its way out past something round
constexpr double k_step_rad = 0.02;   // of the fastest joint: 20 mm at the end of a metre of arm
constexpr std::array k_raises_mm{100.0, 200.0, 350.0};

Clearance clearance_at(const Joints& q_rad, const kinematics::ArmModel& arm,
                       const CollisionModel& collisions) {
  return collisions.clearance(kinematics::joint_frames(arm, q_rad), k_enough_mm);
}

struct Walked {
  bool free{true};
  Clearance nearest{.mm = k_enough_mm, .what = ""};
};

/// Along the legs.  Where the arm stands it may be nearer than the limit (it has just worked there), and it
/// may come no nearer until it is once free; from then on the limit holds, or what the path's own beginning
/// has.
Walked walk(const std::vector<Joints>& stops, const kinematics::ArmModel& arm,
            const CollisionModel& collisions) {
  const double start_mm = clearance_at(stops.front(), arm, collisions).mm;
  const double least_mm = std::min(k_clearance_mm, clearance_at(stops.back(), arm, collisions).mm);
  Walked walked;
  bool left = start_mm >= least_mm;
  for (std::size_t leg = 0; leg + 1 < stops.size(); ++leg) {
    const Joints change_rad = stops[leg + 1] - stops[leg];
    const int steps = 1 + static_cast<int>(change_rad.cwiseAbs().maxCoeff() / k_step_rad);
    for (int i = 1; i <= steps; ++i) {
      const Clearance clearance =
          clearance_at(stops[leg] + change_rad * (static_cast<double>(i) / steps), arm, collisions);
      left = left || clearance.mm >= least_mm;
      if (clearance.mm < walked.nearest.mm) walked.nearest = clearance;
      if (clearance.mm < (left ? least_mm : start_mm - k_leaving_mm)) walked.free = false;
    }
  }
  walked.free = walked.free && left;
  return walked;
}

/// The posture with its flange raised, as near to itself as can be; none when out of reach.
std::optional<Joints> raised(const Joints& q_rad, double by_mm, const kinematics::ArmModel& arm) {
  SE3 T_base_flange = kinematics::forward(arm, q_rad);
  T_base_flange.pretranslate(Vec3{0, 0, by_mm});
  std::optional<Joints> best;
  for (const kinematics::Solution& solution :
       kinematics::inverse(arm, T_base_flange, {.q6_hint_rad = q_rad[5]})) {
    Joints near_rad = solution.q_rad;
    for (int joint = 0; joint < 6; ++joint)
      near_rad[joint] = kinematics::nearest_turn(near_rad[joint], q_rad[joint]);
    if (!best || (near_rad - q_rad).norm() < (*best - q_rad).norm()) best = near_rad;
  }
  return best;
}

/// Between the two ends: nothing, then the ends raised ever higher, one or both.
std::vector<std::vector<Joints>> detours(const Joints& from_rad, const Joints& to_rad,
                                         const kinematics::ArmModel& arm) {
  std::vector<std::vector<Joints>> out{{}};
  for (const double raise_mm : k_raises_mm) {
    const std::optional<Joints> above_from = raised(from_rad, raise_mm, arm),
                                above_to = raised(to_rad, raise_mm, arm);
    if (above_to) out.push_back({*above_to});
    if (above_from) out.push_back({*above_from});
    if (above_from && above_to) out.push_back({*above_from, *above_to});
  }
  return out;
}

}  // namespace

struct WayFinder {
  static CheckedPath entered(PlannedPath path, std::vector<Joints> via_rad) {
    path.via_rad = std::move(via_rad);
    return CheckedPath{std::move(path)};
  }
};

WayThere find_way_there(const Joints& from_rad, const CheckedPath& path, const kinematics::ArmModel& arm,
                        const CollisionModel& collisions) {
  const Joints& to_rad = path.path().waypoints.front().q_rad;
  WayThere out{.check = {.name = "way there",
                         .passed = false,
                         .value = 0,
                         .limit = k_clearance_mm,
                         .unit = "mm",
                         .arc_mm = -1,
                         .detail = ""},
               .path = std::nullopt};
  // A joint turns twice round either way; what is no number or farther leads nowhere.
  if (!(from_rad.cwiseAbs().array() <= 4 * std::numbers::pi).all()) {
    out.check.value = -1;
    out.check.detail = "where the arm stands is not known";
    return out;
  }
  bool direct = true;
  for (const std::vector<Joints>& via_rad : detours(from_rad, to_rad, arm)) {
    std::vector<Joints> stops{from_rad};
    stops.insert(stops.end(), via_rad.begin(), via_rad.end());
    stops.push_back(to_rad);
    const Walked walked = walk(stops, arm, collisions);
    if (direct || walked.free) {
      out.check.value = walked.nearest.mm;
      out.check.detail = walked.free ? ""
                                     : std::string{"from where the arm stands to the path's beginning: "} +
                                           walked.nearest.what;
    }
    direct = false;
    if (!walked.free) continue;
    out.check.passed = true;
    out.path = WayFinder::entered(path.path(), via_rad);
    return out;
  }
  return out;
}

}  // namespace biteline::path
