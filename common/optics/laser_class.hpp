// SPDX-License-Identifier: MIT
#pragma once
/// \file The class of a line laser by IEC 60825-1:2014, for buying and for the cell's papers.  It is no
/// certificate: what counts is a measurement by whom the law asks.
///
/// Covered: 400 to 1050 nm, which is what silicon cameras see, and pulses of 1 us and longer.
/// Assumed, all on the strict side: the source is a point to the eye (C6 = 1; for pulses longer than 5 us
/// C5 = 1 as for all sources below 5 mrad, 0.5 mm at 100 mm), and the line's whole thickness enters the eye.

namespace biteline::optics {

/// A line that fans out of one place.
struct LineLaser {
  double power_mw{5};  ///< all of the line, while it is on
  double wavelength_nm{660};
  double fan_rad{0.84};  ///< full angle; 0: a parallel beam
  double width_mm{0};    ///< of the line where it begins
  double peak_ratio{1};  ///< brightest place of the line over its mean; 1: even
  double nearest_mm{0};  ///< from the fan's vertex to the nearest place where an eye can be
};

/// When it shines.  Pre: length above 0, less than 200 000 pulses a second.
struct Emission {
  double length_s{0};
  double rate_hz{0};  ///< 0: once
};
/// Longer than every time base.
inline constexpr Emission k_continuous{.length_s = 100, .rate_hz = 0};

/// What stands for an eye: a round hole at this distance of the fan's vertex (table 10; table 11 names the
/// vertex for line lasers).
struct Opening {
  double diameter_mm{7};
  double distance_mm{100};
};
inline constexpr Opening k_condition_1{.diameter_mm = 50, .distance_mm = 2000};  ///< binoculars
inline constexpr Opening k_condition_3{.diameter_mm = 7, .distance_mm = 100};    ///< the naked eye

/// Power through the opening at the line's brightest place.
[[nodiscard]] double through_mw(const LineLaser& laser, const Opening& opening);

enum class LaserClass { One, OneM, Two, TwoM, ThreeR, ThreeB, Four };
/// "1", "1M", ... "4".
[[nodiscard]] const char* name_of(LaserClass laser_class);

/// Clause 4.3 f and the limits' own columns.
enum class LaserRule {
  SinglePulse,    ///< one pulse against the limit of its length
  MeanPower,      ///< all pulses of the time base together
  PulseTrain,     ///< one pulse against the limit times C5
  Photochemical,  ///< blue light in 100 s, by C3
};
[[nodiscard]] const char* name_of(LaserRule rule);

/// Emission over a class's limit, by the rule that is strictest.  Below 1 it is of this class.
struct LimitShare {
  double share{0};
  LaserRule rule{LaserRule::SinglePulse};
};

struct LaserJudgement {
  LaserClass laser_class{LaserClass::Four};
  double eye_mw{0}, binoculars_mw{0};             ///< conditions 3 and 1, while it is on
  LimitShare one{}, two{}, three_r{}, three_b{};  ///< of condition 3; `two` is 0 for invisible light
};

/// Limits: tables 3 (class 1), 5 (2), 6 (3R) and 8 (3B).  Time bases (4.3 e): 100 s; 0.25 s for visible
/// light of the classes 2 and 3R.  Between one pulse and the whole time base no stretch of an even train is
/// stricter: pulses grow as their number, limits as its power 0.75.
[[nodiscard]] LaserJudgement judge(const LineLaser& laser, const Emission& emission);

[[nodiscard]] constexpr bool visible(double wavelength_nm) {
  return wavelength_nm >= 400 && wavelength_nm < 700;
}

}  // namespace biteline::optics
