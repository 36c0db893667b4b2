// SPDX-License-Identifier: MIT
#pragma once
/// \file A simulated constant-force flange between arm and tool, commanded by the controller's lines.
///
///     arm's flange [====|--- stroke ---|====] tool -> shoe
///                        0 mm: the tip stands where the controller tells it

#include <array>
#include <cstdint>
#include <limits>
#include <random>

#include "hal/sim/robot/force_control.hpp"

namespace biteline::sim {

struct FlangeFacts {
  int analog_output{0}, analog_input{0};  ///< 0 or 1: the set force, and what it reads; full at full_newton
  int on_output{4}, ready_input{4};       ///< standard digital lines
  double full_newton{100};
  double stroke_mm{30};
  Vec3 axis_tcp{Vec3::UnitZ()};  ///< outwards along it the tool comes out
  double lag_s{0.03};            ///< of its pressure behind the set one
  double off_newton{0.4};        ///< of its force from the set one, by friction and hysteresis
  double noise_newton{0.2};      ///< of its reading, standard deviation
  double rubs_newton_s_mm{0.1};  ///< of its guides and damper, against coming out and going in
  double dead_after_s{std::numeric_limits<double>::infinity()};  ///< switched on: its valve fails
  std::uint64_t seed{1};
};

/// A pneumatic one, as a model: the pressure follows with a first-order lag, the tool goes where pressure,
/// contact and friction are in balance, between the ends of the stroke; off, it is drawn in.  Ready: on, no
/// fault, and force and contact in balance: not on its way out, and not at an end.  Single-threaded.
class ContactFlange {
 public:
  ContactFlange(const FlangeFacts& facts, Touch touch);

  /// One cycle; `T_base_tcp` and outputs as the controller has them.
  void step(const SE3& T_base_tcp, std::uint64_t outputs, const std::array<double, 2>& analog_ratio,
            double step_s);

  [[nodiscard]] bool ready() const;
  /// Of an analog input, V; 0 of one that it is not wired to.
  [[nodiscard]] double volts(int analog_input) const;
  [[nodiscard]] bool is_on() const { return on_; }
  [[nodiscard]] double out_mm() const { return out_mm_; }
  [[nodiscard]] const Vec3& true_newton() const { return true_newton_; }  ///< on the tool, base axes
  [[nodiscard]] const FlangeFacts& facts() const { return facts_; }

 private:
  [[nodiscard]] bool dead() const { return on_s_ > facts_.dead_after_s; }

  FlangeFacts facts_;
  Touch touch_;
  std::mt19937_64 random_;
  bool on_{false};
  double on_s_{0};
  double pushes_newton_{0}, told_newton_{0}, missing_newton_{0};
  double out_mm_;
  Vec3 true_newton_{Vec3::Zero()};
};

}  // namespace biteline::sim
