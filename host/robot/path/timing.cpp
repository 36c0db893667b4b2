// SPDX-License-Identifier: MIT
#include "host/robot/path/timing.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::path {
namespace {

using kinematics::Joints;

// Of each joint's acceleration limit: following the path's bends takes at most this share; what it leaves at
// the speed there is for speeding up.
constexpr double k_bend_share = 0.9;
// Where a straight way bends by more than this the tip stops; below, the blend rounds it.
constexpr double k_corner_cosine = 0.94;  // 20 degrees

double step_mm(const ToolPath& path, std::size_t i) {
  return path.points[i + 1].arc_mm - path.points[i].arc_mm;
}

/// Of a tip on its way in or out: the way to where it works, and how far it stands off there.
double from_work_mm(const ToolPath& path, std::size_t i) {
  const Segment segment = path.points[i].segment;
  std::size_t work = i;
  if (segment == Segment::Approach) {
    while (work + 1 < path.points.size() && path.points[work].segment == segment) ++work;
  } else {
    while (work > 0 && path.points[work].segment == segment) --work;
  }
  const Vec3 way = path.points[i].T_base_tcp.translation() - path.points[work].T_base_tcp.translation();
  return way.norm() + path.standoff_mm;
}

double process_speed_mm_s(const ToolPath& path, std::size_t i, const Motion& motion) {
  constexpr double k_rounding_mm = 1e-6;
  switch (path.points[i].segment) {
    case Segment::Line:
      return motion.speed_mm_s * path.points[i].speed_ratio;
    case Segment::Travel:
      return motion.transfer_speed_mm_s;
    case Segment::Approach:
    case Segment::Retreat:
      break;
  }
  // The last way to the line and the first away from it are slow, wherever beside the line the tip works; the
  // lift is fast, and so is a tip that stands off.
  return from_work_mm(path, i) < motion.approach_mm - k_rounding_mm ? motion.approach_speed_mm_s
                                                                    : motion.transfer_speed_mm_s;
}

/// dq/ds and d2q/ds2 by differences over uneven steps.
struct Derivatives {
  Joints first;
  Joints second;
};
Derivatives derivatives(const ToolPath& path, const JointPath& joints, std::size_t i) {
  const std::size_t n = joints.q_rad.size();
  const std::size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, n - 1);
  const double back_mm = path.points[i].arc_mm - path.points[a].arc_mm,
               ahead_mm = path.points[b].arc_mm - path.points[i].arc_mm;
  Derivatives d{.first = Joints::Zero(), .second = Joints::Zero()};
  if (back_mm + ahead_mm <= 0) return d;
  d.first = (joints.q_rad[b] - joints.q_rad[a]) / (back_mm + ahead_mm);
  if (back_mm > 0 && ahead_mm > 0) {
    d.second =
        2 * ((joints.q_rad[b] - joints.q_rad[i]) / ahead_mm - (joints.q_rad[i] - joints.q_rad[a]) / back_mm) /
        (back_mm + ahead_mm);
  }
  return d;
}

/// What the joints leave for speeding up and slowing down at one place.
class Room {
 public:
  Room(const kinematics::ArmModel& arm, const Derivatives& d, double most_mm_s2)
      : first_{d.first.cwiseAbs()},
        second_{d.second.cwiseAbs()},
        most_rad_s2_{arm.limits.acceleration_rad_s2},
        most_mm_s2_{most_mm_s2} {}
  [[nodiscard]] double at_mm_s2(double speed_mm_s) const {
    double room_mm_s2 = most_mm_s2_;
    for (int joint = 0; joint < 6; ++joint) {
      if (!(first_[joint] > 1e-9)) continue;
      const double bend_rad_s2 =
          std::min(second_[joint] * speed_mm_s * speed_mm_s, k_bend_share * most_rad_s2_[joint]);
      room_mm_s2 = std::min(room_mm_s2, (most_rad_s2_[joint] - bend_rad_s2) / first_[joint]);
    }
    return room_mm_s2;
  }

 private:
  Joints first_, second_, most_rad_s2_;
  double most_mm_s2_;
};

bool stops_at(const ToolPath& path, std::size_t i, const Motion& motion) {
  if (i == 0 || i + 1 == path.points.size()) return true;
  const Segment here = path.points[i].segment, before = path.points[i - 1].segment,
                after = path.points[i + 1].segment;
  if ((here == Segment::Line || here == Segment::Travel) && before == here && after == here)
    return false;  // rounded: its curvature limits the speed
  if (here == Segment::Travel && after == here) return false;
  if (here == Segment::Travel ? after != here : after == Segment::Travel) return true;
  // A controller drives a straight way at the fastest speed planned on it: what is slow is a way of its own.
  const auto slower = [&](std::size_t other) {
    const bool stands_off = path.standoff_mm >= motion.approach_mm;
    const double at_work_mm_s = stands_off ? motion.transfer_speed_mm_s : motion.approach_speed_mm_s;
    const bool working = path.points[other].segment == Segment::Line;
    return (working ? at_work_mm_s : process_speed_mm_s(path, other, motion)) <
           process_speed_mm_s(path, i, motion);
  };
  if (here == Segment::Approach && slower(i + 1)) return true;
  if (here == Segment::Retreat && slower(i - 1)) return true;
  const Vec3 p = path.points[i].T_base_tcp.translation();
  const Vec3 in = p - path.points[i - 1].T_base_tcp.translation(),
             out = path.points[i + 1].T_base_tcp.translation() - p;
  return in.dot(out) < k_corner_cosine * in.norm() * out.norm();
}

/// From stop to stop beside the line in a straight way: the slowest place's speed for all.
void even_out_ways(const ToolPath& path, std::vector<double>& speed_mm_s) {
  const auto moves_on_way = [&](std::size_t i) {
    if (i >= speed_mm_s.size() || speed_mm_s[i] <= 0) return false;
    return path.points[i].segment == Segment::Approach || path.points[i].segment == Segment::Retreat;
  };
  for (std::size_t first = 0; first < speed_mm_s.size(); ++first) {
    if (!moves_on_way(first)) continue;
    std::size_t end = first;
    while (moves_on_way(end)) ++end;
    const auto begin = speed_mm_s.begin();
    const auto from = begin + static_cast<std::ptrdiff_t>(first),
               to = begin + static_cast<std::ptrdiff_t>(end);
    std::fill(from, to, *std::min_element(from, to));
    first = end;
  }
}

}  // namespace

Timing time_path(const kinematics::ArmModel& arm, const ToolPath& path, const JointPath& joints,
                 const Motion& motion) {
  const std::size_t n = path.points.size();
  Timing timing{.speed_mm_s = std::vector<double>(n), .time_s = std::vector<double>(n)};
  std::vector<Room> rooms;

  for (std::size_t i = 0; i < n; ++i) {
    double limit_mm_s = std::min(process_speed_mm_s(path, i, motion), k_most_speed_mm_s);
    const double curvature = path.points[i].curvature_per_mm;
    if (curvature > 1e-6)
      limit_mm_s = std::min(limit_mm_s, std::sqrt(motion.cross_acceleration_mm_s2 / curvature));
    const Derivatives d = derivatives(path, joints, i);
    rooms.emplace_back(arm, d, motion.acceleration_mm_s2);
    for (int joint = 0; joint < 6; ++joint) {
      const double first = std::abs(d.first[joint]), second = std::abs(d.second[joint]);
      const double most_rad_s2 = arm.limits.acceleration_rad_s2[joint];
      if (first > 1e-9)
        limit_mm_s = std::min(limit_mm_s, motion.joint_speed_ratio * arm.limits.speed_rad_s[joint] / first);
      if (second > 1e-9) limit_mm_s = std::min(limit_mm_s, std::sqrt(k_bend_share * most_rad_s2 / second));
    }
    timing.speed_mm_s[i] = stops_at(path, i, motion) ? 0 : limit_mm_s;
  }
  even_out_ways(path, timing.speed_mm_s);
  // From one place to the next, in either direction of time, what the joints leave at both.
  const auto reach = [&](std::size_t from, std::size_t to) {
    const double v = timing.speed_mm_s[from], step = step_mm(path, std::min(from, to));
    const auto faster = [&](double a) { return std::sqrt(v * v + 2 * a * step); };
    const double begun = std::min(timing.speed_mm_s[to], faster(rooms[from].at_mm_s2(v)));
    const double a = std::min(rooms[from].at_mm_s2(v), rooms[to].at_mm_s2(begun));
    timing.speed_mm_s[to] = std::min(begun, faster(a));
  };
  for (std::size_t i = 0; i + 1 < n; ++i) reach(i, i + 1);
  for (std::size_t i = n - 1; i > 0; --i) reach(i, i - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double mean_mm_s = 0.5 * (timing.speed_mm_s[i] + timing.speed_mm_s[i + 1]);
    const double a = std::min(rooms[i].at_mm_s2(0), rooms[i + 1].at_mm_s2(0));
    // From stop to stop in one step: faster, at most as fast as the program drives it, and slower again.
    const bool worked =
        path.points[i].segment == Segment::Line && path.points[i + 1].segment == Segment::Line;
    const double most_mm_s =
        std::min(worked ? process_speed_mm_s(path, i, motion) : motion.approach_speed_mm_s,
                 std::sqrt(a * step_mm(path, i)));
    if (!worked && mean_mm_s > 0) {
      const auto [slow, fast] = std::minmax(timing.speed_mm_s[i], timing.speed_mm_s[i + 1]);
      const double ramp_mm = (fast * fast - slow * slow) / (2 * a);
      timing.time_s[i + 1] =
          timing.time_s[i] + (fast - slow) / a + std::max(step_mm(path, i) - ramp_mm, 0.0) / fast;
      continue;
    }
    const double step_s = mean_mm_s > 0 ? step_mm(path, i) / mean_mm_s
                                        : (most_mm_s > 0 ? step_mm(path, i) / most_mm_s + most_mm_s / a : 0);
    timing.time_s[i + 1] = timing.time_s[i] + step_s;
  }
  return timing;
}

JointAcceleration worst_acceleration(const kinematics::ArmModel& arm, const ToolPath& path,
                                     const JointPath& joints, const Timing& timing) {
  JointAcceleration worst;
  for (std::size_t i = 1; i + 1 < joints.q_rad.size(); ++i) {
    const double back_s = timing.time_s[i] - timing.time_s[i - 1],
                 ahead_s = timing.time_s[i + 1] - timing.time_s[i];
    if (back_s <= 0 || ahead_s <= 0) continue;
    const Joints a = ((joints.q_rad[i + 1] - joints.q_rad[i]) / ahead_s -
                      (joints.q_rad[i] - joints.q_rad[i - 1]) / back_s) *
                     (2 / (back_s + ahead_s));
    for (int joint = 0; joint < 6; ++joint) {
      const double ratio = std::abs(a[joint]) / arm.limits.acceleration_rad_s2[joint];
      if (ratio > worst.ratio) worst = {.ratio = ratio, .arc_mm = path.points[i].arc_mm, .joint = joint};
    }
  }
  return worst;
}

}  // namespace biteline::path
