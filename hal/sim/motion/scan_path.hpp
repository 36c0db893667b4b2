// SPDX-License-Identifier: MIT
#pragma once
/// \file The way of the head round a shoe: the beam along the outline's inward normal, the camera beside it.

#include "hal/sim/render/made_head.hpp"
#include "hal/sim/shoe/outline.hpp"

namespace biteline::sim {

/// Of the stripe where an arm sets out and stops, unless a joint asks for less.
inline constexpr double k_scan_acceleration_mm_s2 = 1000;
/// The way over which it comes to the scan's speed.
[[nodiscard]] constexpr double ramp_mm(double speed_mm_s) {
  constexpr double k_least_mm = 10;
  const double way_mm = speed_mm_s * speed_mm_s / (2 * k_scan_acceleration_mm_s2);
  return way_mm > k_least_mm ? way_mm : k_least_mm;
}

/// How the head holds itself where the scan's end and its begin see the same wall, so that a calibration that
/// is off shows there: at the begin turned and shifted one way, at the end the other way, hardly at all in
/// between.  What the arm passes while it sets out and stops is seen, too: that overlap takes no time.
struct CheckLap {
  double length_mm{0};  ///< both ends overlap by so much, 50 is usual; 0: no such lap
  double yaw_rad{0.27}, pitch_rad{0.25}, roll_rad{0.27};  ///< about height, travel and beam
  double away_mm{8};                                      ///< along the beam, farther off at both ends
  double height_mm{20};                                   ///< the begin is seen from so much higher
};

struct ScanPathSettings {
  double target_z_mm{36};                 ///< height of the working point, shoe frame
  double pitch_rad{k_bracket_pitch_rad};  ///< the beam looks down by this much
  double speed_mm_s{100};                 ///< of the stripe along the outline
  /// The beam turns with the outline's mean direction over so much of it, so that an arm can follow; 0: along
  /// its normal at each place.
  double turn_over_mm{0};
  double begin_mm{0};  ///< along the outline: where the scan begins and ends
  double lead_mm{2};   ///< begins so far before that place and ends so far beyond it
  CheckLap check{};
};

/// Constant speed along the outline from time 0 on.
class ScanPath {
 public:
  ScanPath(const Outline& outline, const MadeHead& head, const ScanPathSettings& settings);

  [[nodiscard]] double length_mm() const;
  [[nodiscard]] double duration_s() const;
  /// Where the camera is `way_mm` after the path's begin; any number, the path repeats.
  [[nodiscard]] SE3 T_shoe_cam_at(double way_mm) const;
  /// Outline place under the stripe there.
  [[nodiscard]] double s_at_mm(double way_mm) const {
    return settings_.begin_mm + way_mm - settings_.lead_mm;
  }
  [[nodiscard]] const ScanPathSettings& settings() const { return settings_; }
  [[nodiscard]] const Outline& outline() const { return outline_; }

 private:
  [[nodiscard]] Vec2 outwards_at(double s_mm) const;
  [[nodiscard]] SE3 T_beam_checking_at(double way_mm) const;
  /// What the arm's ramps leave to be overlapped.
  [[nodiscard]] double overlap_mm() const;

  Outline outline_;
  ScanPathSettings settings_;
  SE3 T_beam_cam_;  ///< camera in the head's own frame: working point, z along the beam, x along camera
                    ///< columns
};

}  // namespace biteline::sim
