// SPDX-License-Identifier: MIT
#include "host/robot/path/timing.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::path {
namespace {

using kinematics::Joints;

// Of each joint's acceleration limit: a share for following the path's bends at constant speed, the rest for
// speeding up.
constexpr double k_bend_share = 0.5;
// Where a straight way bends by more than this the tip stops; below, the blend rounds it.
constexpr double k_corner_cosine = 0.94;  // 20 degrees

double step_mm(const ToolPath& path, std::size_t i) {
  return path.points[i + 1].arc_mm - path.points[i].arc_mm;
}

double process_speed_mm_s(const ToolPath& path, std::size_t i, const Motion& motion) {
  switch (path.points[i].segment) {
    case Segment::Line:
      return motion.speed_mm_s * path.points[i].speed_ratio;
    case Segment::Approach:
    case Segment::Retreat:
    case Segment::Travel:
      break;
  }
  // The last way to the line and the first away from it are slow, the lift is fast.
  const Vec3 to_line = path.points[i].T_base_tcp.translation() - path.points[i].line_base;
  return to_line.norm() < 2 * motion.approach_mm + motion.spacing_mm ? motion.approach_speed_mm_s
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

bool stops_at(const ToolPath& path, std::size_t i) {
  if (i == 0 || i + 1 == path.points.size()) return true;
  const Segment here = path.points[i].segment, before = path.points[i - 1].segment,
                after = path.points[i + 1].segment;
  if ((here == Segment::Line || here == Segment::Travel) && before == here && after == here)
    return false;  // rounded: its curvature limits the speed
  if (here == Segment::Travel && after == here) return false;
  if (here == Segment::Travel ? after != here : after == Segment::Travel) return true;
  const Vec3 p = path.points[i].T_base_tcp.translation();
  const Vec3 in = p - path.points[i - 1].T_base_tcp.translation(),
             out = path.points[i + 1].T_base_tcp.translation() - p;
  return in.dot(out) < k_corner_cosine * in.norm() * out.norm();
}

}  // namespace

Timing time_path(const kinematics::ArmModel& arm, const ToolPath& path, const JointPath& joints,
                 const Motion& motion) {
  const std::size_t n = path.points.size();
  Timing timing{.speed_mm_s = std::vector<double>(n), .time_s = std::vector<double>(n)};
  std::vector<double> acceleration_mm_s2(n, motion.acceleration_mm_s2);

  for (std::size_t i = 0; i < n; ++i) {
    double limit_mm_s = process_speed_mm_s(path, i, motion);
    const double curvature = path.points[i].curvature_per_mm;
    if (curvature > 1e-6)
      limit_mm_s = std::min(limit_mm_s, std::sqrt(motion.cross_acceleration_mm_s2 / curvature));
    const Derivatives d = derivatives(path, joints, i);
    for (int joint = 0; joint < 6; ++joint) {
      const double first = std::abs(d.first[joint]), second = std::abs(d.second[joint]);
      const double most_rad_s2 = arm.limits.acceleration_rad_s2[joint];
      if (first > 1e-9) {
        limit_mm_s = std::min(limit_mm_s, motion.joint_speed_ratio * arm.limits.speed_rad_s[joint] / first);
        acceleration_mm_s2[i] = std::min(acceleration_mm_s2[i], (1 - k_bend_share) * most_rad_s2 / first);
      }
      if (second > 1e-9) limit_mm_s = std::min(limit_mm_s, std::sqrt(k_bend_share * most_rad_s2 / second));
    }
    timing.speed_mm_s[i] = stops_at(path, i) ? 0 : limit_mm_s;
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double a = std::min(acceleration_mm_s2[i], acceleration_mm_s2[i + 1]);
    const double v = timing.speed_mm_s[i];
    timing.speed_mm_s[i + 1] =
        std::min(timing.speed_mm_s[i + 1], std::sqrt(v * v + 2 * a * step_mm(path, i)));
  }
  for (std::size_t i = n - 1; i > 0; --i) {
    const double a = std::min(acceleration_mm_s2[i], acceleration_mm_s2[i - 1]);
    const double v = timing.speed_mm_s[i];
    timing.speed_mm_s[i - 1] =
        std::min(timing.speed_mm_s[i - 1], std::sqrt(v * v + 2 * a * step_mm(path, i - 1)));
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double mean_mm_s = 0.5 * (timing.speed_mm_s[i] + timing.speed_mm_s[i + 1]);
    const double a = std::min(acceleration_mm_s2[i], acceleration_mm_s2[i + 1]);
    // From stop to stop in one step: half the way faster, half slower.
    const double step_s = mean_mm_s > 0 ? step_mm(path, i) / mean_mm_s : 2 * std::sqrt(step_mm(path, i) / a);
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
