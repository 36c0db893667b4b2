// SPDX-License-Identifier: MIT
#include "hal/sim/live/arm_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "hal/sim/live/fastest_way.hpp"
#include "hal/sim/robot/arm_body.hpp"

namespace biteline::sim {

namespace {

/// Between samples of the way: the sharpest toe, 20 mm, then turns by 6 degrees.
constexpr double k_step_mm = 2;
/// Neighbouring samples of one posture; a jump to another one is farther.
constexpr double k_most_between_rad = 0.35;
/// Over the shoe's place before and after the scan.
constexpr double k_raised_mm = 200;
/// Free space that a path keeps.
constexpr double k_clearance_mm = 10;
/// Housings of camera and laser about their lens and window, and the bracket.
constexpr double k_camera_radius_mm = 38, k_laser_radius_mm = 30, k_bracket_radius_mm = 25;

/// Why a posture does not do, and how far it came: the reason of the one that came farthest is told.
struct Obstacle {
  std::string words{"no posture of the arm reaches it"};
  double at_mm{-1e9};
};

SE3 T_base_flange_at(const ScanPath& path, const MadeHead& head, const ScanPlace& place, double way_mm) {
  return place.T_base_shoe * path.T_shoe_cam_at(way_mm) * head.model.T_flange_cam.inverse(Eigen::Isometry);
}

/// What the head adds to the arm's body, in the flange.
std::array<NamedCapsule, 3> head_body(const MadeHead& head, const SE3& T_base_flange) {
  const SE3 T_base_cam = T_base_flange * head.model.T_flange_cam;
  const Vec3 camera = T_base_cam.translation(), laser = T_base_cam * head.laser.emitter_cam;
  const Vec3 hangs = 0.5 * (camera + laser), flange = T_base_flange * Vec3(0, 0, k_bracket_radius_mm);
  return {{{"camera", {.a = camera, .b = camera, .radius_mm = k_camera_radius_mm}},
           {"laser", {.a = laser, .b = laser, .radius_mm = k_laser_radius_mm}},
           {"bracket", {.a = flange, .b = hangs, .radius_mm = k_bracket_radius_mm}}}};
}

/// Free space between a capsule and the shoe, taken as its outline drawn straight up to its top.
double from_shoe_mm(const Capsule& capsule, const std::vector<Vec3>& outline_base, double top_z_mm) {
  double least_mm = 1e9;
  for (const Vec3& foot : outline_base) {
    const Vec3 top{foot.x(), foot.y(), top_z_mm};
    least_mm = std::min(least_mm, between_mm(capsule, {.a = foot, .b = top, .radius_mm = 0}));
  }
  return least_mm;
}

class Surroundings {
 public:
  Surroundings(const ScanPath& path, const MadeHead& head, const ArmKinematics& arm, const ScanPlace& place)
      : head_(head), arm_(arm), table_z_mm_(place.T_base_shoe.translation().z()) {
    top_z_mm_ = table_z_mm_ + place.top_z_mm;
    constexpr double k_spacing_mm = 10;
    for (double s_mm = 0; s_mm < path.outline().perimeter_mm(); s_mm += k_spacing_mm) {
      const Vec2 p = path.outline().at(s_mm).point;
      outline_base_.emplace_back(place.T_base_shoe * Vec3(p.x(), p.y(), 0));
    }
  }

  /// What would be touched, in words; nothing when all is clear.
  [[nodiscard]] std::optional<std::string> touched(const JointVector& q_rad) const {
    const auto arm = arm_body(arm_, q_rad);
    const auto head = head_body(head_, arm_.T_base_flange(q_rad));
    const auto touch = [](const NamedCapsule& what, const char* other) {
      return std::string(what.name) + " touches the " + other;
    };
    const auto over_table_mm = [&](const Capsule& c) {
      return std::min(c.a.z(), c.b.z()) - c.radius_mm - table_z_mm_;
    };
    for (std::size_t i = 3; i < arm.size(); ++i) {  // what is before the elbow stands on the same floor
      if (over_table_mm(arm[i].capsule) < k_clearance_mm) return touch(arm[i], "table");
      if (from_shoe_mm(arm[i].capsule, outline_base_, top_z_mm_) < k_clearance_mm)
        return touch(arm[i], "shoe");
    }
    for (const NamedCapsule& part : head) {
      if (over_table_mm(part.capsule) < 0) return touch(part, "table");
      if (from_shoe_mm(part.capsule, outline_base_, top_z_mm_) < k_clearance_mm) return touch(part, "shoe");
      for (std::size_t i = 0; i < 5; ++i) {  // the wrist carries the head
        if (between_mm(part.capsule, arm[i].capsule) < k_clearance_mm) return touch(part, arm[i].name);
      }
    }
    for (std::size_t i = 4; i < arm.size(); ++i) {
      if (between_mm(arm[i].capsule, arm[0].capsule) < k_clearance_mm) return touch(arm[i], arm[0].name);
    }
    for (std::size_t i = 6; i < arm.size(); ++i) {
      if (between_mm(arm[i].capsule, arm[2].capsule) < k_clearance_mm) return touch(arm[i], arm[2].name);
    }
    return std::nullopt;
  }

 private:
  const MadeHead& head_;
  const ArmKinematics& arm_;
  double table_z_mm_, top_z_mm_{0};
  std::vector<Vec3> outline_base_;
};

/// Common postures over the place: elbow up or down, wrist either way.
std::vector<JointVector> postures(const SE3& T_base_flange, const ArmKinematics& arm) {
  std::vector<JointVector> found;
  const Vec3 at = T_base_flange.translation();
  for (const double shoulder : {0.0, std::numbers::pi}) {
    for (const double elbow : {1.6, -1.6}) {
      for (const double wrist : {-1.57, 1.57}) {
        for (const double lift : {-2.0, -1.2}) {
          JointVector start_rad;
          start_rad << std::atan2(at.y(), at.x()) + shoulder, shoulder == 0 ? -std::numbers::pi - lift : lift,
              elbow, -1.6, wrist, 0;
          auto q_rad = arm.joints_near(T_base_flange, start_rad);
          if (!q_rad) continue;
          for (double& angle_rad : *q_rad) angle_rad = std::remainder(angle_rad, 2 * std::numbers::pi);
          const auto same = [&](const JointVector& other) { return (other - *q_rad).norm() < 1e-3; };
          if (std::none_of(found.begin(), found.end(), same)) found.push_back(*q_rad);
        }
      }
    }
  }
  return found;
}

/// Each joint turned back by whole turns, so that its range over the way lies as near to zero as it can.
void centre_turns(std::vector<JointVector>& way_rad) {
  for (Eigen::Index i = 0; i < 6; ++i) {
    double low = 1e9, high = -1e9;
    for (const JointVector& q_rad : way_rad) {
      low = std::min(low, q_rad[i]);
      high = std::max(high, q_rad[i]);
    }
    const double whole_rad = 2 * std::numbers::pi * std::round((low + high) / 2 / (2 * std::numbers::pi));
    for (JointVector& q_rad : way_rad) q_rad[i] -= whole_rad;
  }
}

}  // namespace

Result<ArmScan> ArmScan::plan(const ScanPath& path, const MadeHead& head, const ArmKinematics& arm,
                              const ScanPlace& place) {
  const double speed = path.settings().speed_mm_s;
  const double lead_mm = ramp_mm(speed);
  const auto samples = static_cast<std::size_t>(std::ceil((path.length_mm() + 2 * lead_mm) / k_step_mm)) + 1;
  std::vector<SE3> flange;
  for (std::size_t i = 0; i < samples; ++i) {
    const double way_mm = k_step_mm * static_cast<double>(i) - lead_mm;
    flange.push_back(
        T_base_flange_at(path, head, place, place.clockwise ? path.length_mm() - way_mm : way_mm));
  }
  const Surroundings surroundings(path, head, arm, place);

  Obstacle obstacle;
  std::optional<ArmScan> best;
  const auto blocked = [&](std::size_t i, const std::string& words) {
    const double at_mm = k_step_mm * static_cast<double>(i) - lead_mm;
    if (at_mm > obstacle.at_mm) obstacle = {.words = words, .at_mm = at_mm};
    return false;
  };
  const auto follow = [&](const JointVector& begin_rad, ArmScan& scan) {
    scan.q_rad_ = {begin_rad};
    for (std::size_t i = 1; i < samples; ++i) {
      const auto next = arm.joints_near(flange[i], scan.q_rad_.back());
      if (!next || (*next - scan.q_rad_.back()).cwiseAbs().maxCoeff() > k_most_between_rad)
        return blocked(i, "the arm does not reach on from there");
      scan.q_rad_.push_back(*next);
    }
    centre_turns(scan.q_rad_);
    for (std::size_t i = 0; i < samples; ++i) {
      if (i % 5 == 0) {
        if (const auto touched = surroundings.touched(scan.q_rad_[i])) return blocked(i, *touched);
      }
      for (Eigen::Index joint = 0; joint < 6; ++joint) {
        if (std::abs(scan.q_rad_[i][joint]) > arm.limits().most_rad[joint])
          return blocked(i, "joint " + std::to_string(joint + 1) + " turns farther than it may");
      }
    }
    const auto raised = [&](const SE3& T, const JointVector& near_rad) {
      return arm.joints_near(Eigen::Translation3d(0, 0, k_raised_mm) * T, near_rad);
    };
    const auto above_begin = raised(flange.front(), scan.q_rad_.front());
    const auto above_end = raised(flange.back(), scan.q_rad_.back());
    if (!above_begin || !above_end) return blocked(samples, "the arm does not reach the place above it");
    scan.above_begin_rad_ = *above_begin;
    scan.above_end_rad_ = *above_end;
    scan.take_speeds(arm.limits(), speed, lead_mm, path.length_mm());
    if (path.settings().check.length_mm > 0) scan.see_ramps();
    return true;
  };
  for (const JointVector& begin_rad : postures(flange.front(), arm)) {
    ArmScan scan;
    if (follow(begin_rad, scan) && (!best || scan.duration_s() < best->duration_s())) best = std::move(scan);
  }
  if (best) return std::move(*best);
  if (obstacle.at_mm < -1e8) return fail(Errc::OutOfReach, "%s", obstacle.words.c_str());
  return fail(Errc::OutOfReach, "%s, %.0f mm along the outline", obstacle.words.c_str(), obstacle.at_mm);
}

std::vector<double> ArmScan::overloads(const JointLimits& limits) const {
  constexpr double k_cycle_s = 0.002;
  std::vector<double> most(q_rad_.size(), 0);
  std::size_t at = 0;
  JointVector a = q_rad_at(0), b = q_rad_at(k_cycle_s);
  for (double t = 2 * k_cycle_s; t <= duration_s(); t += k_cycle_s) {
    const JointVector c = q_rad_at(t);
    while (at + 1 < time_s_.size() && time_s_[at + 1] <= t - k_cycle_s) ++at;
    const JointVector v = (c - a) / (2 * k_cycle_s), dv = (c - 2 * b + a) / (k_cycle_s * k_cycle_s);
    // Slower by a factor: accelerations fall by its square.
    most[at] = std::max({most[at], v.cwiseQuotient(limits.speed_rad_s).cwiseAbs().maxCoeff(),
                         std::sqrt(dv.cwiseQuotient(limits.acceleration_rad_s2).cwiseAbs().maxCoeff())});
    a = b;
    b = c;
  }
  return most;
}

void ArmScan::take_speeds(const JointLimits& limits, double speed_mm_s, double lead_mm, double length_mm) {
  WayLimits way{.joints = limits,
                .speed_mm_s = speed_mm_s,
                .acceleration_mm_s2 = k_scan_acceleration_mm_s2,
                .slower = std::vector<double>(q_rad_.size(), 1)};
  // The quickest law has its edges taken off, which asks some joints too much: there the next one is slower.
  constexpr int k_rounds = 4, k_side = 6;
  for (int round = 0; round < k_rounds; ++round) {
    speed_mm_s_ = fastest_way(q_rad_, k_step_mm, way);
    set_times(lead_mm, length_mm);
    const std::vector<double> over = overloads(limits);
    const auto count = static_cast<std::ptrdiff_t>(over.size());
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const auto from = over.begin() + std::max<std::ptrdiff_t>(0, i - k_side),
                 to = over.begin() + std::min(count, i + k_side + 1);
      way.slower[static_cast<std::size_t>(i)] *= std::max(1.0, *std::max_element(from, to));
    }
  }
  const std::vector<double> over = overloads(limits);
  const double most = std::max(1.0, *std::max_element(over.begin(), over.end()));
  for (double& speed : speed_mm_s_) speed /= most;
  set_times(lead_mm, length_mm);
}

void ArmScan::set_times(double lead_mm, double length_mm) {
  time_s_.assign(1, 0);
  for (std::size_t i = 1; i < q_rad_.size(); ++i)
    time_s_.push_back(time_s_.back() + 2 * k_step_mm / (speed_mm_s_[i - 1] + speed_mm_s_[i]));
  full_from_s_ = time_of_s(lead_mm / k_step_mm);
  full_until_s_ = time_of_s((lead_mm + length_mm) / k_step_mm);
  slowest_mm_s_ = 1e9;
  for (std::size_t i = 0; i < time_s_.size(); ++i) {
    if (time_s_[i] >= full_from_s_ && time_s_[i] <= full_until_s_)
      slowest_mm_s_ = std::min(slowest_mm_s_, speed_mm_s_[i]);
  }
}

void ArmScan::see_ramps() {
  // Slower, the arm takes many pictures of one place; at the end somebody waits for the line.
  constexpr double k_share_at_begin = 0.2, k_share_at_end = 0.7;
  const double most_mm_s = *std::max_element(speed_mm_s_.begin(), speed_mm_s_.end());
  const auto quicker_than = [&](double share) {
    return [least_mm_s = share * most_mm_s](double speed_mm_s) { return speed_mm_s >= least_mm_s; };
  };
  const auto first = std::find_if(speed_mm_s_.begin(), speed_mm_s_.end(), quicker_than(k_share_at_begin)) -
                     speed_mm_s_.begin();
  const auto behind =
      std::find_if(speed_mm_s_.rbegin(), speed_mm_s_.rend(), quicker_than(k_share_at_end)).base() -
      speed_mm_s_.begin();
  full_from_s_ = std::min(full_from_s_, time_s_[static_cast<std::size_t>(first)]);
  full_until_s_ = std::max(full_until_s_, time_s_[static_cast<std::size_t>(behind - 1)]);
}

double ArmScan::time_of_s(double place) const {
  const auto i = std::min(static_cast<std::size_t>(place), time_s_.size() - 2);
  return time_s_[i] + (place - static_cast<double>(i)) * (time_s_[i + 1] - time_s_[i]);
}

JointVector ArmScan::q_rad_at(double time_s) const {
  if (time_s <= 0) return q_rad_.front();
  if (time_s >= duration_s()) return q_rad_.back();
  const auto after =
      static_cast<std::size_t>(std::upper_bound(time_s_.begin(), time_s_.end(), time_s) - time_s_.begin());
  const std::size_t i = after - 1, last = q_rad_.size() - 1;
  const double part_s = time_s - time_s_[i];
  const double change = (speed_mm_s_[after] - speed_mm_s_[i]) / (time_s_[after] - time_s_[i]);
  const double u = std::clamp((speed_mm_s_[i] + 0.5 * change * part_s) * part_s / k_step_mm, 0.0, 1.0);
  // A cubic through the samples with the slope between their neighbours: no joint's speed jumps.
  const JointVector &a = q_rad_[i], &b = q_rad_[after];
  const JointVector slope_a = (b - q_rad_[i == 0 ? 0 : i - 1]) / (i == 0 ? 1 : 2);
  const JointVector slope_b = (q_rad_[std::min(after + 1, last)] - a) / (after == last ? 1 : 2);
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * a + (u3 - 2 * u2 + u) * slope_a + (3 * u2 - 2 * u3) * b +
         (u3 - u2) * slope_b;
}

JointEase::JointEase(const JointVector& from_rad, const JointVector& to_rad, const JointLimits& limits)
    : from_rad_(from_rad), to_rad_(to_rad) {
  // x = 3 u^2 - 2 u^3: 1.5 times the mean speed in the middle, 6 times way over time squared at the ends.
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double way_rad = std::abs(to_rad[i] - from_rad[i]);
    duration_s_ = std::max({duration_s_, 1.5 * way_rad / limits.speed_rad_s[i],
                            std::sqrt(6 * way_rad / limits.acceleration_rad_s2[i])});
  }
}

JointVector JointEase::q_rad_at(double time_s) const {
  if (duration_s_ <= 0) return to_rad_;
  const double u = std::clamp(time_s / duration_s_, 0.0, 1.0);
  return from_rad_ + u * u * (3 - 2 * u) * (to_rad_ - from_rad_);
}

}  // namespace biteline::sim
