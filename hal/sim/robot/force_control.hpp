// SPDX-License-Identifier: MIT
#pragma once
/// \file The simulated controller's force mode, and the force sensor in the arm's flange.

#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <string_view>

#include "hal/sim/robot/script_expression.hpp"

namespace biteline::sim {

/// What presses on the tool, N in base axes, while its tip is there; called once each cycle.
using Touch = std::function<Vec3(const SE3& T_base_tcp, double step_s)>;

/// The sensor's errors and the regulator's temper.  As it stands: a sensor without errors.
struct ForceFacts {
  double noise_newton{0};  ///< of each reading and axis, standard deviation
  /// Of the reading in tcp axes, root mean square over places; even within some 50 mm.  A UR5e's force mode
  /// was measured with 8.95 to 13.26 N at a set 10 N, by its place (Sensors 26(5), 1709, 2026): 1.1 N.
  double place_newton{0};
  double drift_newton_per_s{0};    ///< of the reading with time, standard deviation of its rate over runs
  std::uint64_t seed{1};           ///< of the arm: its errors by place
  std::uint64_t noise_seed{1};     ///< of the run: noise, and how the reading drifts
  double lag_s{0.010};             ///< first-order, of the reading that the regulator takes
  double answer_mm_s2_newton{18};  ///< of the tip, for each N that is missing: 3 Hz on 20 N/mm
  /// Of the tip's own speed: without damping, and what full damping adds.
  double braking_per_s{10}, damping_per_s{100};
};

/// A UR's sensor and regulator as they were measured (ForceFacts); noise and drift as sensors of its range
/// have them.
[[nodiscard]] constexpr ForceFacts common_force_facts(std::uint64_t seed) {
  return {.noise_newton = 0.5, .place_newton = 1.1, .drift_newton_per_s = 0.02, .seed = seed};
}

/// By the script's words (Universal Robots, "The URScript Programming Language": force_mode and its family):
/// one or more straight axes of a task frame follow a force, at most at the limits' speed; the others follow
/// the program.  Type 2 alone, and no compliant turns.  Its temper is a model: speed' = gain * answer * (set
/// - told) - (braking + damping) * speed.  What the program moves along a compliant axis is added.  When it
/// ends, the tip goes back to the program's way evenly.  Single-threaded.
class ForceControl {
 public:
  ForceControl(const ForceFacts& facts, Touch touch);

  /// false: no such function, or not with these values.
  [[nodiscard]] bool act(std::string_view function, std::span<const ScriptValue> arguments);
  /// The program is over.
  void end() { on_ = false; }
  /// The arm stands where it is, and no program says where it ought to be.
  void stand() {
    on_ = false;
    off_base_mm_.setZero();
  }
  /// One cycle; `T_base_tcp` as the program has it.
  void step(const SE3& T_base_tcp, double step_s);

  [[nodiscard]] bool is_on() const { return on_; }
  /// Of the tip from the program's way, mm in base axes.
  [[nodiscard]] const Vec3& off_base_mm() const { return off_base_mm_; }
  /// On the tool, base axes: as it is, and as the sensor tells it.
  [[nodiscard]] const Vec3& true_newton() const { return true_newton_; }
  [[nodiscard]] const Vec3& told_newton() const { return told_newton_; }

 private:
  struct Wave {
    Vec3 per_mm;
    double phase_rad;
  };
  [[nodiscard]] bool begin(std::span<const ScriptValue> arguments);
  [[nodiscard]] Vec3 error_at(const Vec3& tip_base) const;
  void sense(const SE3& T_base_tcp, double step_s);
  void regulate(double step_s);
  void let_go(double step_s);

  ForceFacts facts_;
  Touch touch_;
  std::mt19937_64 random_;
  static constexpr std::size_t k_waves = 3;
  std::array<std::array<Wave, k_waves>, 3> waves_{};
  Vec3 drift_newton_per_s_{Vec3::Zero()};
  bool on_{false};
  Mat3 R_base_task_{Mat3::Identity()};
  std::array<bool, 3> compliant_{};
  Vec3 wanted_newton_{Vec3::Zero()}, limit_mm_s_{Vec3::Zero()};
  double damping_{0.025}, gain_{1};  ///< the script manual's defaults
  double time_s_{0};
  Vec3 zero_tcp_{Vec3::Zero()}, raw_tcp_{Vec3::Zero()};  ///< N, in the sensor's own axes
  Vec3 slow_newton_{Vec3::Zero()};
  Vec3 true_newton_{Vec3::Zero()}, told_newton_{Vec3::Zero()};
  Vec3 off_base_mm_{Vec3::Zero()}, speed_base_mm_s_{Vec3::Zero()};
};

}  // namespace biteline::sim
