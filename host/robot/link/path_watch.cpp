// SPDX-License-Identifier: MIT
#include "host/robot/link/path_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "host/robot/link/ur/force_script.hpp"
#include "host/robot/path/force.hpp"

namespace biteline::robot {
namespace {

using kinematics::Joints;

constexpr double k_deg_per_rad = 180 / std::numbers::pi;
constexpr double k_beginning_mm = 0.5;  // so near to its first waypoint the tip is on the path
constexpr double k_back_mm = 2;         // blends and the controller's noise
constexpr double k_slack_mm = 3;        // ahead, beyond what the tip can have gone since
constexpr double k_least_ratio = 0.05;  // a slider at zero must not stop the clock of a stall
constexpr double k_late_share = 0.25;   // a controller ramps in its own way: 15 % were met
constexpr double k_force_lag_s = 0.2;   // of a reading that shakes with the tool
constexpr double k_tool_mm = 0.1, k_tool_rad = 0.002;

HaltReason halt(Halt code, const FixedText<200>& text) {
  return {.code = code, .reason = std::string{text.view()}};
}

/// How far the joints are beside the straight leg, and where on it.
struct Beside {
  double rad{0};
  double fraction{0};
  Eigen::Index joint{0};
};

Beside beside_leg(const Joints& q_rad, const Joints& from_rad, const Joints& to_rad) {
  const Joints along = to_rad - from_rad;
  const double length2 = along.squaredNorm();
  Beside out;
  out.fraction = length2 > 0 ? std::clamp((q_rad - from_rad).dot(along) / length2, 0.0, 1.0) : 1.0;
  out.rad = (q_rad - from_rad - out.fraction * along).cwiseAbs().maxCoeff(&out.joint);
  return out;
}

}  // namespace

PathWatch::PathWatch(const path::PlannedPath& path, const path::FollowLimits& limits, const RobotState& from)
    : path_{path}, limits_{limits}, last_{from.sampled} {
  stops_.push_back(from.q_rad);
  stops_.insert(stops_.end(), path.via_rad.begin(), path.via_rad.end());
  stops_.push_back(path.waypoints.front().q_rad);
  for (const path::Waypoint& w : path.waypoints) fastest_mm_s_ = std::max(fastest_mm_s_, w.speed_mm_s);
}

std::optional<HaltReason> PathWatch::look(const RobotState& state) {
  step_s_ = std::clamp(static_cast<double>((state.sampled - last_).count()) * 1e-9, 0.0, 1.0);
  last_ = state.sampled;
  word_is_new_ = word_is_new_ || state.force_word < static_cast<int>(ur::ForceWord::Untouched);
  if (!on_path_ && at_beginning(state)) on_path_ = true;
  return on_path_ ? look_at_path(state) : look_at_way(state);
}

bool PathWatch::at_beginning(const RobotState& state) const {
  const path::PathPlace place = path::nearest_place(path_, state.T_base_tcp.translation(),
                                                    {.from_mm = 0, .to_mm = fastest_mm_s_ * step_s_});
  const Joints& a = path_.waypoints[place.segment].q_rad;
  const Joints& b = path_.waypoints[place.segment + 1].q_rad;
  const double off_rad = (state.q_rad - a - place.fraction * (b - a)).cwiseAbs().maxCoeff();
  return place.distance_mm <= k_beginning_mm && off_rad <= limits_.off_way_rad;
}

std::optional<HaltReason> PathWatch::look_at_way(const RobotState& state) {
  Beside best = beside_leg(state.q_rad, stops_[leg_], stops_[leg_ + 1]);
  // Behind a corner only the next leg counts; a state that came late may be a leg farther on.
  for (std::size_t leg = leg_ + 1; leg + 1 < stops_.size(); ++leg) {
    if (best.fraction < 1 && best.rad <= limits_.off_way_rad) break;
    const Beside next = beside_leg(state.q_rad, stops_[leg], stops_[leg + 1]);
    if (next.rad > limits_.off_way_rad) continue;
    leg_ = leg;
    best = next;
  }
  if (state.q_rad.allFinite() && best.rad <= limits_.off_way_rad) return std::nullopt;
  return halt(
      Halt::OffWay,
      FixedText<200>::format("joint %d is %.1f degrees beside the way to the path's beginning (limit %.1f)",
                             static_cast<int>(best.joint) + 1, best.rad * k_deg_per_rad,
                             limits_.off_way_rad * k_deg_per_rad));
}

std::optional<HaltReason> PathWatch::look_at_path(const RobotState& state) {
  const SE3 tool = state.T_flange_tcp.inverse() * path_.T_flange_tcp;
  const double tool_mm = tool.translation().norm(), tool_rad = geometry::log_so3(tool.linear()).norm();
  if (!(tool_mm <= k_tool_mm && tool_rad <= k_tool_rad)) {
    return halt(Halt::OtherTool, FixedText<200>::format(
                                     "the controller's tool tip is %.1f mm and %.1f degrees from the plan's",
                                     tool_mm, tool_rad * k_deg_per_rad));
  }
  const double ahead_mm = fastest_mm_s_ * step_s_ + k_slack_mm;
  const path::PathPlace place = path::nearest_place(
      path_, state.T_base_tcp.translation(), {.from_mm = here_mm_ - k_back_mm, .to_mm = here_mm_ + ahead_mm});
  if (auto told = look_at_word(state)) return told;
  const double off_mm = path::off_path_mm(path_, place, state.T_base_tcp.translation());
  if (!(off_mm <= limits_.off_path_mm)) {
    return halt(Halt::OffPath,
                FixedText<200>::format("the tip is %.1f mm beside the path at %.0f mm of it (limit %.1f)",
                                       off_mm, here_mm_, limits_.off_path_mm));
  }
  const double turned_rad =
      geometry::angle_between_rad(path::pose_at(path_, place).linear(), state.T_base_tcp.linear());
  if (!(turned_rad <= limits_.off_path_rad)) {
    return halt(
        Halt::OffDirection,
        FixedText<200>::format("the tool is turned by %.1f degrees at %.0f mm of the path (limit %.1f)",
                               turned_rad * k_deg_per_rad, here_mm_, limits_.off_path_rad * k_deg_per_rad));
  }
  if (auto force = look_at_force(state, place)) return force;
  here_mm_ = std::max(here_mm_, std::min(path::arc_at(path_, place), here_mm_ + ahead_mm));
  running_s_ += step_s_ * std::max(state.speed_ratio, k_least_ratio);
  return look_at_time(path::time_at(path_, place));
}

std::optional<HaltReason> PathWatch::look_at_word(const RobotState& state) const {
  if (!path::presses(path_) || !word_is_new_) return std::nullopt;
  const path::Force& force = *path_.force;
  switch (static_cast<ur::ForceWord>(state.force_word)) {
    case ur::ForceWord::Untouched:
      return halt(Halt::NoContact,
                  FixedText<200>::format("the tool did not touch the shoe within %.1f mm", force.reach_mm));
    case ur::ForceWord::Lost:
      return halt(Halt::ContactLost, FixedText<200>::format("no contact for %.2f s at %.0f mm of the path",
                                                            force.lost_s, here_mm_));
    case ur::ForceWord::TooHigh:
      return halt(Halt::ForceTooHigh,
                  FixedText<200>::format("the tool presses with more than %.0f N at %.0f mm of the path",
                                         force.most_newton, here_mm_));
    case ur::ForceWord::FlangeDead:
      return halt(Halt::FlangeDead,
                  FixedText<200>::format("the flange was not ready, or read less than half of its force, for "
                                         "%.2f s at %.0f mm of the path",
                                         force.lost_s, here_mm_));
    case ur::ForceWord::None:
    case ur::ForceWord::Seeks:
    case ur::ForceWord::Presses:
      break;
  }
  return std::nullopt;
}

std::optional<HaltReason> PathWatch::look_at_force(const RobotState& state, const path::PathPlace& place) {
  if (!path::presses(path_) || path_.force->tolerance_ratio == 0) return std::nullopt;
  const bool presses = state.force_word == static_cast<int>(ur::ForceWord::Presses);
  const path::Waypoint& here = path_.waypoints[place.segment];
  const std::optional<Vec3> felt =
      path::felt_newton(path_, place, state.force_base_newton, state.flange_ratio);
  if (!presses || !felt || here.segment != path::Segment::Line) {
    pressed_ = false;
    force_off_s_ = 0;
    return std::nullopt;
  }
  const double told = -felt->dot(path::press_at(path_, place));
  const double share = step_s_ / (step_s_ + k_force_lag_s);
  pressed_newton_ = std::exchange(pressed_, true) ? pressed_newton_ + share * (told - pressed_newton_) : told;
  const double off = std::abs(pressed_newton_ - here.force_newton);
  const double allowed = path_.force->tolerance_ratio * path_.force->set_newton;
  force_off_s_ = off <= allowed ? 0 : force_off_s_ + step_s_;
  if (force_off_s_ <= limits_.stall_s) return std::nullopt;
  return halt(Halt::ForceOff,
              FixedText<200>::format("the tool presses with %.1f N for %.1f N at %.0f mm of the "
                                     "path (limit %.1f off, for %.1f s)",
                                     pressed_newton_, here.force_newton, here_mm_, allowed, limits_.stall_s));
}

std::optional<HaltReason> PathWatch::look_at_time(double planned_s) {
  if (here_mm_ >= advanced_mm_ + path::k_least_advance_mm) {
    advanced_mm_ = here_mm_;
    advanced_at_s_ = running_s_;
  }
  // At the path's end the program may take its time to end: follow() has a limit for that.
  if (here_mm_ >= path_.waypoints.back().arc_mm - k_beginning_mm) return std::nullopt;
  if (running_s_ - advanced_at_s_ > limits_.stall_s) {
    return halt(Halt::Stalled,
                FixedText<200>::format("the tip stands at %.0f mm of the path for %.1f s (limit %.1f)",
                                       here_mm_, running_s_ - advanced_at_s_, limits_.stall_s));
  }
  const double late_s = running_s_ - planned_s, allowed_s = limits_.late_s + k_late_share * planned_s;
  if (std::abs(late_s) <= allowed_s) return std::nullopt;
  return halt(Halt::Late, FixedText<200>::format(
                              "the tip is %.1f s %s the plan at %.0f mm of the path (limit %.1f)",
                              std::abs(late_s), late_s > 0 ? "behind" : "ahead of", here_mm_, allowed_s));
}

}  // namespace biteline::robot
