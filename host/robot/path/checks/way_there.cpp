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
constexpr double k_tip_mm = 2;        // of the tool's end, as thin as its axis: what the path itself keeps
constexpr double k_enough_mm = 50;
constexpr double k_leaving_mm = 0.5;  // on its way out past something round
constexpr double k_step_rad = 0.02;   // of the fastest joint: 20 mm at the end of a metre of arm
constexpr std::array k_raises_mm{15.0, 40.0, 100.0, 200.0, 350.0};

struct Walked {
  bool free{true};
  Clearance nearest{.mm = k_enough_mm, .what = ""};
};

/// Of the body, and of the tip, which works nowhere on this way.
struct Clearances {
  Clearance body, tip;
};
Clearances clearances_at(const Joints& q_rad, const kinematics::ArmModel& arm,
                         const CollisionModel& collisions) {
  const auto frames = kinematics::joint_frames(arm, q_rad);
  return {.body = collisions.clearance(frames, k_enough_mm),
          .tip = collisions.tip_clearance(frames.back(), k_enough_mm)};
}

/// How far anything from the elbow to the tip goes for a radian of the fastest joint, at most.
double most_mm_per_rad(const std::vector<Joints>& stops, const kinematics::ArmModel& arm, const Vec3& tip) {
  const auto places = [&](const Joints& q_rad) {
    const auto frames = kinematics::joint_frames(arm, q_rad);
    std::vector<Vec3> out;
    for (std::size_t i = 1; i < frames.size(); ++i) out.emplace_back(frames[i].translation());
    out.emplace_back(frames.back() * tip);
    return out;
  };
  double most = 0;
  for (std::size_t leg = 0; leg + 1 < stops.size(); ++leg) {
    const Joints change_rad = stops[leg + 1] - stops[leg];
    const double way_rad = change_rad.cwiseAbs().maxCoeff();
    const int steps = 1 + static_cast<int>(way_rad / k_step_rad);
    std::vector<Vec3> before = places(stops[leg]);
    for (int i = 1; i <= steps && way_rad > 0; ++i) {
      std::vector<Vec3> here = places(stops[leg] + change_rad * (static_cast<double>(i) / steps));
      for (std::size_t k = 0; k < here.size(); ++k)
        most = std::max(most, (here[k] - before[k]).norm() * steps / way_rad);
      before = std::move(here);
    }
  }
  return most;
}

/// Along the legs.  Where the arm stands it may be nearer than the limit (it has just worked there), and it
/// may come no nearer until it is once free; from then on the limit holds, or what the path's own beginning
/// has.  So does the tip's, from where it is once free on.
Walked walk(const std::vector<Joints>& stops, const kinematics::ArmModel& arm,
            const CollisionModel& collisions) {
  const Clearances begin = clearances_at(stops.front(), arm, collisions),
                   end = clearances_at(stops.back(), arm, collisions);
  const double least_mm = std::min(k_clearance_mm, end.body.mm), tip_mm = std::min(k_tip_mm, end.tip.mm);
  Walked walked;
  bool left = begin.body.mm >= least_mm, tip_left = begin.tip.mm >= tip_mm;
  for (std::size_t leg = 0; leg + 1 < stops.size(); ++leg) {
    const Joints change_rad = stops[leg + 1] - stops[leg];
    const int steps = 1 + static_cast<int>(change_rad.cwiseAbs().maxCoeff() / k_step_rad);
    for (int i = 1; i <= steps; ++i) {
      const Clearances here =
          clearances_at(stops[leg] + change_rad * (static_cast<double>(i) / steps), arm, collisions);
      left = left || here.body.mm >= least_mm;
      tip_left = tip_left || here.tip.mm >= tip_mm;
      if (here.body.mm < walked.nearest.mm) walked.nearest = here.body;
      if (here.body.mm < (left ? least_mm : begin.body.mm - k_leaving_mm)) walked.free = false;
      if (!tip_left || here.tip.mm >= tip_mm) continue;
      walked.free = false;
      if (here.tip.mm < walked.nearest.mm) walked.nearest = here.tip;
    }
  }
  walked.free = walked.free && left && tip_left;
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

/// Over which postures an arm comes from the one to the other; the direct way's nearest where none is free.
struct FreeWay {
  Walked walked{};
  std::vector<Joints> via_rad{};
};
FreeWay find_free_way(const Joints& from_rad, const Joints& to_rad, const kinematics::ArmModel& arm,
                      const CollisionModel& collisions) {
  std::optional<FreeWay> direct;
  for (const std::vector<Joints>& via_rad : detours(from_rad, to_rad, arm)) {
    std::vector<Joints> stops{from_rad};
    stops.insert(stops.end(), via_rad.begin(), via_rad.end());
    stops.push_back(to_rad);
    FreeWay way{.walked = walk(stops, arm, collisions), .via_rad = via_rad};
    if (way.walked.free) return way;
    if (!direct) direct = std::move(way);
  }
  return *direct;
}

/// From where the arm stands to the path's beginning, over the place where its tool purges.
struct Legs {
  Walked walked{};
  std::vector<Joints> via_rad{};
  std::optional<std::size_t> purge_via{};
};
Legs find_legs(const Joints& from_rad, const PlannedPath& path, const kinematics::ArmModel& arm,
               const CollisionModel& collisions) {
  const Joints& to_rad = path.waypoints.front().q_rad;
  if (path.purge_rad) {
    const Clearances there = clearances_at(*path.purge_rad, arm, collisions);
    if (there.body.mm < k_clearance_mm) return {.walked = {.free = false, .nearest = there.body}};
    if (there.tip.mm < k_tip_mm) return {.walked = {.free = false, .nearest = there.tip}};
  }
  FreeWay way = find_free_way(from_rad, path.purge_rad.value_or(to_rad), arm, collisions);
  Legs legs{.walked = way.walked, .via_rad = std::move(way.via_rad)};
  if (!path.purge_rad || !legs.walked.free) return legs;
  legs.purge_via = legs.via_rad.size();
  legs.via_rad.push_back(*path.purge_rad);
  way = find_free_way(*path.purge_rad, to_rad, arm, collisions);
  legs.via_rad.insert(legs.via_rad.end(), way.via_rad.begin(), way.via_rad.end());
  legs.walked.free = way.walked.free;
  if (!way.walked.free || way.walked.nearest.mm < legs.walked.nearest.mm)
    legs.walked.nearest = way.walked.nearest;
  return legs;
}

}  // namespace

struct WayFinder {
  static CheckedPath entered(PlannedPath path, const Legs& legs, double speed_rad_s) {
    path.via_rad = legs.via_rad;
    path.purge_via = legs.purge_via;
    path.way_there_rad_s = speed_rad_s;
    return CheckedPath{std::move(path)};
  }
};

bool is_free_way(const Joints& from_rad, const Joints& to_rad, const kinematics::ArmModel& arm,
                 const CollisionModel& collisions) {
  return walk({from_rad, to_rad}, arm, collisions).free;
}

WayThere find_way_there(const Joints& from_rad, const CheckedPath& path, const kinematics::ArmModel& arm,
                        const CollisionModel& collisions) {
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
  const Legs legs = find_legs(from_rad, path.path(), arm, collisions);
  out.check.value = legs.walked.nearest.mm;
  out.check.passed = legs.walked.free;
  if (!legs.walked.free) {
    out.check.detail =
        std::string{"from where the arm stands to the path's beginning: "} + legs.walked.nearest.what;
    return out;
  }
  std::vector<Joints> stops{from_rad};
  stops.insert(stops.end(), legs.via_rad.begin(), legs.via_rad.end());
  stops.push_back(path.path().waypoints.front().q_rad);
  const Motion& motion = path.path().motion;
  const double most_mm = std::max(1.0, most_mm_per_rad(stops, arm, path.path().T_flange_tcp.translation()));
  const double speed_rad_s =
      std::clamp(motion.transfer_speed_mm_s / most_mm, motion.way_there_rad_s,
                 std::max(motion.way_there_rad_s, k_most_way_ratio * motion.way_there_rad_s));
  out.path = WayFinder::entered(path.path(), legs, speed_rad_s);
  return out;
}

}  // namespace biteline::path
