// SPDX-License-Identifier: MIT
#include "hal/sim/robot/contact_flange.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace biteline::sim {
namespace {

constexpr double k_fastest_mm_s = 200, k_drawn_in_mm_s = 100;
constexpr double k_at_end_mm = 0.2;
/// Of force and contact in balance, beside a share of the force.
constexpr double k_balance_newton = 1.5, k_balance_ratio = 0.3;
constexpr double k_full_volts = 10;

}  // namespace

ContactFlange::ContactFlange(const FlangeFacts& facts, Touch touch)
    : facts_{facts}, touch_{std::move(touch)}, random_{facts.seed}, out_mm_{-facts.stroke_mm / 2} {}

void ContactFlange::step(const SE3& T_base_tcp, std::uint64_t outputs,
                         const std::array<double, 2>& analog_ratio, double step_s) {
  on_ = (outputs >> static_cast<unsigned>(facts_.on_output) & 1U) != 0;
  if (on_) on_s_ += step_s;
  const bool pushes = on_ && !dead();
  const double set =
      pushes ? analog_ratio.at(static_cast<std::size_t>(facts_.analog_output)) * facts_.full_newton : 0;
  pushes_newton_ += (1 - std::exp(-step_s / facts_.lag_s)) * (set - pushes_newton_);
  const Vec3 axis_base = T_base_tcp.linear() * facts_.axis_tcp;
  SE3 T_base_tip = T_base_tcp;
  T_base_tip.translation() += out_mm_ * axis_base;
  true_newton_ = touch_ ? touch_(T_base_tip, step_s) : Vec3{Vec3::Zero()};
  // Friction holds it back on either way.
  missing_newton_ = pushes_newton_ + true_newton_.dot(axis_base);
  const double moves =
      std::copysign(std::max(0.0, std::abs(missing_newton_) - facts_.off_newton), missing_newton_);
  const double speed =
      on_ ? std::clamp(moves / facts_.rubs_newton_s_mm, -k_fastest_mm_s, k_fastest_mm_s) : -k_drawn_in_mm_s;
  out_mm_ = std::clamp(out_mm_ + speed * step_s, -facts_.stroke_mm / 2, facts_.stroke_mm / 2);
  std::normal_distribution<double> noise{0, facts_.noise_newton};
  told_newton_ = std::max(0.0, pushes_newton_ + noise(random_));
}

bool ContactFlange::ready() const {
  const double allowed_newton = std::max(k_balance_newton, k_balance_ratio * pushes_newton_);
  return on_ && !dead() && std::abs(missing_newton_) < allowed_newton &&
         std::abs(out_mm_) < facts_.stroke_mm / 2 - k_at_end_mm;
}

double ContactFlange::volts(int analog_input) const {
  if (analog_input != facts_.analog_input) return 0;
  return std::min(k_full_volts, k_full_volts * told_newton_ / facts_.full_newton);
}

}  // namespace biteline::sim
