// SPDX-License-Identifier: MIT
#pragma once
/// \file What a model's shoes teach of the force: the sensor's error by its place, and what to add ahead.

#include <filesystem>
#include <span>
#include <vector>

#include "common/core/result.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::path {

/// One reading while the tool goes along the line; both in tcp axes, as the sensor's own errors are.
struct ForceSample {
  double round_ratio{0};          ///< of its place (Waypoint::round_ratio)
  Vec3 told_tcp{Vec3::Zero()};    ///< N on the tool, by the arm's or the flange's sensor
  Vec3 press_tcp{Vec3::UnitZ()};  ///< into the shoe (Waypoint::press_base)
  [[nodiscard]] double pressed_newton() const { return -told_tcp.dot(press_tcp); }
};

inline constexpr std::size_t k_force_places = 144;  ///< 4 to 5 mm of a shoe's line

/// By place: of each place the mean of its samples, smoothed over neighbours (Gaussian, one place). Places
/// without a sample take their neighbours'; no sample at all: zeros.
[[nodiscard]] std::vector<Vec3> by_place(std::span<const ForceSample> samples, Vec3 ForceSample::*value);

/// A run of the same path beside the shoe (first_run.hpp, force_air_run()), where nothing presses: all that
/// the sensor tells is its error.  Only its change from place to place counts: each run zeroes the sensor.
void learn_air(ForceLearned& learned, std::span<const ForceSample> samples);

/// Of one run.
struct ShoePlace {
  double begin_ratio{0};  ///< where the sensor was zeroed
  double lead_ratio{
      0};  ///< of the line's length: so far before a place its force is asked for (k_force_lag_s)
};
/// One worked shoe: iterative learning control (Bristow, Tharayil, Alleyne, "A survey of iterative learning
/// control", IEEE Control Systems 26(3), 2006) with a gain that falls with the shoes seen.  The true force is
/// taken for what the sensor told less its known error; what is missing of the set force is added for the
/// next shoe, within half of the set force.  Samples of ramps are left out by the caller.
void learn_shoe(ForceLearned& learned, std::span<const ForceSample> samples, const ShoePlace& place);
/// From the force that is asked for to the force: of a regulator of some 2 to 3 Hz.
inline constexpr double k_force_lag_s = 0.08;

/// N: the sensor's error by its place, and what is added ahead; each the largest of all places.
struct ForceDrift {
  double error_newton{0}, ahead_newton{0};
};
[[nodiscard]] ForceDrift drift_of(const ForceLearned& learned);

/// YAML: set_n, air_runs, shoes, error_x_n, error_y_n, error_z_n, ahead_n.  Strict.
[[nodiscard]] Result<ForceLearned> read_force_learned(const std::filesystem::path& file);
[[nodiscard]] Result<void> write_force_learned(const std::filesystem::path& file,
                                               const ForceLearned& learned);

}  // namespace biteline::path
