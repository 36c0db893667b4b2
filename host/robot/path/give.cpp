// SPDX-License-Identifier: MIT
#include "host/robot/path/give.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/robot/kinematics/chain.hpp"

namespace biteline::path {
namespace {

using kinematics::Joints;
using AtWork = Eigen::Matrix<double, 3, 6>;

// Bends are taken over so much to either side: the springs do not follow what is shorter.
constexpr double k_bend_arm_mm = 6;

Joints own_rad_s(const kinematics::ArmModel& arm) {
  return 2 * std::numbers::pi * arm.give.natural_hz;
}

/// The place at or beyond `k_bend_arm_mm` in that direction, or the last one.
std::size_t beside(std::span<const GivePlace> places, std::size_t i, int direction) {
  std::size_t k = i;
  while ((direction < 0 ? k > 0 : k + 1 < places.size()) &&
         std::abs(places[k].arc_mm - places[i].arc_mm) < k_bend_arm_mm)
    k = direction < 0 ? k - 1 : k + 1;
  return k;
}

/// How what the tool works at goes across the line where the joints turn.
AtWork across(const kinematics::ArmModel& arm, std::span<const GivePlace> places, std::size_t i) {
  const Vec3 along = places[beside(places, i, 1)].work_base - places[beside(places, i, -1)].work_base;
  const AtWork J = kinematics::jacobian(arm, places[i].q_rad, places[i].work_base).topRows<3>();
  if (!(along.norm() > 0)) return J;  // on the way in or out: all of it
  const Vec3 t = along.normalized();
  return J - t * (t.transpose() * J);
}

/// The tip's speed in a step, `time_s` after its begin: an even ramp at its slower end, as long as the step's
/// time says, and the faster end's speed.
double speed_at(const GivePlace& a, const GivePlace& b, double time_s) {
  const double whole_s = b.time_s - a.time_s, way_mm = b.arc_mm - a.arc_mm;
  const auto [slow, fast] = std::minmax(a.speed_mm_s, b.speed_mm_s);
  // From stop to stop: faster and slower again.
  if (!(fast > 0)) return 4 * way_mm / (whole_s * whole_s) * std::min(time_s, whole_s - time_s);
  if (!(fast > slow)) return fast;
  const double ramp_s = std::clamp(2 * (fast * whole_s - way_mm) / (fast - slow), 1e-9, whole_s);
  const double in_ramp_s = a.speed_mm_s < b.speed_mm_s ? time_s : whole_s - time_s;
  return slow + (fast - slow) * std::min(in_ramp_s / ramp_s, 1.0);
}

/// The joints' turn for each mm of the tip's way, at one place.
Joints turn_per_mm(std::span<const GivePlace> places, std::size_t i) {
  const GivePlace &a = places[i > 0 ? i - 1 : i], &b = places[std::min(i + 1, places.size() - 1)];
  const double way_mm = b.arc_mm - a.arc_mm;
  if (!(way_mm > 0)) return Joints::Zero();
  return (b.q_rad - a.q_rad) / way_mm;
}

/// The same at `part` of the step from place i: straight in its middle, rounded at both ends, as blends are.
Joints turn_within(std::span<const GivePlace> places, std::size_t i, double part) {
  const GivePlace &a = places[i], &b = places[i + 1];
  const Joints straight =
      b.arc_mm > a.arc_mm ? Joints{(b.q_rad - a.q_rad) / (b.arc_mm - a.arc_mm)} : Joints{Joints::Zero()};
  const Joints end = turn_per_mm(places, part < 0.5 ? i : i + 1);
  return end + (1 - std::abs(2 * part - 1)) * (straight - end);
}

/// Links on springs behind drives.
class Springs {
 public:
  explicit Springs(const kinematics::ArmModel& arm)
      : w_{own_rad_s(arm).array()}, damping_{2 * arm.give.damping_ratio * w_} {}

  void step(const Joints& drive_rad_s, double step_s) {
    const Eigen::Array<double, 6, 1> give_rad_s = link_rad_s_ - drive_rad_s.array();
    link_rad_s_ -= step_s * (damping_ * give_rad_s + w_ * w_ * give_rad_);
    give_rad_ += step_s * (link_rad_s_ - drive_rad_s.array());
  }
  [[nodiscard]] Joints give_rad() const { return give_rad_.matrix(); }

 private:
  Eigen::Array<double, 6, 1> w_, damping_;
  Eigen::Array<double, 6, 1> give_rad_{Eigen::Array<double, 6, 1>::Zero()},
      link_rad_s_{Eigen::Array<double, 6, 1>::Zero()};
};

}  // namespace

std::vector<GiveRate> give_rates(const kinematics::ArmModel& arm, std::span<const GivePlace> places) {
  const Joints per_w2 = own_rad_s(arm).array().square().inverse();
  std::vector<GiveRate> rates(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const GivePlace &a = places[beside(places, i, -1)], &here = places[i], &b = places[beside(places, i, 1)];
    const double back_mm = here.arc_mm - a.arc_mm, ahead_mm = b.arc_mm - here.arc_mm;
    if (!(back_mm + ahead_mm > 0)) continue;
    const AtWork J = across(arm, places, i);
    const Joints first = (b.q_rad - a.q_rad) / (back_mm + ahead_mm);
    rates[i].per_acceleration = -J * first.cwiseProduct(per_w2);
    if (!(back_mm > 0) || !(ahead_mm > 0)) continue;
    const Joints second =
        2 * ((b.q_rad - here.q_rad) / ahead_mm - (here.q_rad - a.q_rad) / back_mm) / (back_mm + ahead_mm);
    rates[i].per_speed2 = -J * second.cwiseProduct(per_w2);
  }
  return rates;
}

std::vector<double> give_along_mm(const kinematics::ArmModel& arm, std::span<const GivePlace> places) {
  constexpr double k_step_s = 1e-3;
  std::vector<double> out(places.size(), 0.0);
  Springs springs{arm};
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const GivePlace &a = places[i], &b = places[i + 1];
    const double whole_s = b.time_s - a.time_s;
    if (!(whole_s > 0)) continue;
    const AtWork J = across(arm, places, i + 1);
    const int steps = std::max(1, static_cast<int>(std::ceil(whole_s / k_step_s)));
    for (int k = 0; k < steps; ++k) {
      const double part = (k + 0.5) / steps;
      springs.step(turn_within(places, i, part) * speed_at(a, b, part * whole_s), whole_s / steps);
      out[i + 1] = std::max(out[i + 1], (J * springs.give_rad()).norm());
    }
  }
  return out;
}

}  // namespace biteline::path
