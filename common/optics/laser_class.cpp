// SPDX-License-Identifier: MIT
#include "common/optics/laser_class.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::optics {
namespace {

/// Pulses closer together than this count as one (table 2, 400 to 1050 nm).
constexpr double k_group_s = 5e-6;
/// Looking away (4.3 e), and without it.
constexpr double k_blink_s = 0.25, k_stare_s = 100;
/// Beyond it a point's heat balances: T2 of table 9.
constexpr double k_balance_s = 10;

double c3(double wavelength_nm) {
  return wavelength_nm < 450 ? 1 : std::pow(10, 0.02 * (wavelength_nm - 450));
}

double c4(double wavelength_nm) {
  return wavelength_nm < 700 ? 1 : std::pow(10, 0.002 * (wavelength_nm - 700));
}

// Limits in joule for an emission of this length.

double class_one_j(double wavelength_nm, double length_s) {
  const double factor = c4(wavelength_nm);
  if (length_s < k_group_s) return 7.7e-8 * factor;
  return (length_s < k_balance_s ? 7e-4 * std::pow(length_s, 0.75) : 3.9e-4 * length_s) * factor;
}

double class_two_j(double wavelength_nm, double length_s) {
  return length_s < k_blink_s ? class_one_j(wavelength_nm, length_s) : 1e-3 * length_s;
}

double class_three_r_j(double wavelength_nm, double length_s) {
  const bool seen = visible(wavelength_nm);
  const double factor = c4(wavelength_nm);
  if (length_s < k_group_s) return 3.8e-7 * factor;
  if (length_s < (seen ? k_blink_s : k_balance_s)) return 3.5e-3 * std::pow(length_s, 0.75) * factor;
  return (seen ? 5e-3 : 2e-3 * factor) * length_s;
}

double class_three_b_j(double wavelength_nm, double length_s) {
  const double factor = c4(wavelength_nm);
  return length_s < 0.06 * factor ? 0.03 * factor : 0.5 * length_s;
}

using Limit = double (*)(double wavelength_nm, double length_s);

/// Through one opening.
struct Seen {
  double power_w, wavelength_nm;
  Emission emission;
};

/// Pulses that begin within this time, at least one.
double pulses_in(const Emission& emission, double time_s) {
  return std::max(1.0, std::ceil(emission.rate_hz * time_s));
}

/// Energy of all pulses of this time.
double energy_j(const Seen& seen, double time_s) {
  const double lit_s = pulses_in(seen.emission, time_s) * seen.emission.length_s;
  return seen.power_w * std::min(lit_s, time_s);
}

void take_stricter(LimitShare& most, double share, LaserRule rule) {
  if (share > most.share) most = {.share = share, .rule = rule};
}

/// C5 of table 9 for a point: pulses up to 5 us alone, where the time base is above 0.25 s.
double c5(const Emission& emission, double base_s) {
  if (emission.length_s > k_group_s || base_s <= k_blink_s) return 1;
  const double pulses = pulses_in(emission, std::min(base_s, k_balance_s));
  // Between 600 and 625 pulses the formula is a hair above 1: no pulse is allowed more than alone.
  return pulses <= 600 ? 1 : std::clamp(5 * std::pow(pulses, -0.25), 0.4, 1.0);
}

LimitShare share_of(const Seen& seen, Limit limit_j, double base_s) {
  const double pulse_s = std::min(seen.emission.length_s, base_s);
  const double single = seen.power_w * pulse_s / limit_j(seen.wavelength_nm, pulse_s);
  LimitShare most{.share = single, .rule = LaserRule::SinglePulse};
  take_stricter(most, energy_j(seen, base_s) / limit_j(seen.wavelength_nm, base_s), LaserRule::MeanPower);
  take_stricter(most, single / c5(seen.emission, base_s), LaserRule::PulseTrain);
  return most;
}

LimitShare share_of_one(const Seen& seen) {
  LimitShare most = share_of(seen, class_one_j, k_stare_s);
  if (seen.wavelength_nm < 600)
    take_stricter(most, energy_j(seen, k_stare_s) / (3.9e-3 * c3(seen.wavelength_nm)),
                  LaserRule::Photochemical);
  return most;
}

struct Shares {
  LimitShare one, two, three_r, three_b;
};

Shares shares_of(const Seen& seen) {
  Shares shares{
      .one = share_of_one(seen),
      .two = {},
      .three_r = share_of(seen, class_three_r_j, visible(seen.wavelength_nm) ? k_blink_s : k_stare_s),
      .three_b = share_of(seen, class_three_b_j, k_stare_s)};
  if (visible(seen.wavelength_nm)) shares.two = share_of(seen, class_two_j, k_blink_s);
  return shares;
}

/// 5.3: the first class whose conditions all hold.
LaserClass class_of(const Shares& eye, const Shares& binoculars, bool seen) {
  const auto holds = [](const LimitShare& limit) { return limit.share <= 1; };
  const bool not_four = holds(binoculars.three_b) && holds(eye.three_b);
  if (holds(eye.one) && holds(binoculars.one)) return LaserClass::One;
  if (holds(eye.one) && not_four) return LaserClass::OneM;
  if (seen && holds(eye.two) && holds(binoculars.two)) return LaserClass::Two;
  if (seen && holds(eye.two) && not_four) return LaserClass::TwoM;
  if (holds(eye.three_r) && holds(binoculars.three_r)) return LaserClass::ThreeR;
  return not_four ? LaserClass::ThreeB : LaserClass::Four;
}

}  // namespace

double through_mw(const LineLaser& laser, const Opening& opening) {
  const double distance_mm = std::max(opening.distance_mm, laser.nearest_mm);
  const double line_mm = laser.width_mm + 2 * distance_mm * std::tan(laser.fan_rad / 2);
  if (line_mm <= opening.diameter_mm) return laser.power_mw;
  return laser.power_mw * std::min(1.0, laser.peak_ratio * opening.diameter_mm / line_mm);
}

const char* name_of(LaserClass laser_class) {
  switch (laser_class) {
    case LaserClass::One:
      return "1";
    case LaserClass::OneM:
      return "1M";
    case LaserClass::Two:
      return "2";
    case LaserClass::TwoM:
      return "2M";
    case LaserClass::ThreeR:
      return "3R";
    case LaserClass::ThreeB:
      return "3B";
    case LaserClass::Four:
      return "4";
  }
  return "";
}

const char* name_of(LaserRule rule) {
  switch (rule) {
    case LaserRule::SinglePulse:
      return "single_pulse";
    case LaserRule::MeanPower:
      return "mean_power";
    case LaserRule::PulseTrain:
      return "pulse_train";
    case LaserRule::Photochemical:
      return "photochemical";
  }
  return "";
}

LaserJudgement judge(const LineLaser& laser, const Emission& emission) {
  LaserJudgement judgement;
  judgement.eye_mw = through_mw(laser, k_condition_3);
  judgement.binoculars_mw = through_mw(laser, k_condition_1);
  const Shares eye = shares_of({judgement.eye_mw / 1000, laser.wavelength_nm, emission});
  const Shares far = shares_of({judgement.binoculars_mw / 1000, laser.wavelength_nm, emission});
  judgement.one = eye.one;
  judgement.two = eye.two;
  judgement.three_r = eye.three_r;
  judgement.three_b = eye.three_b;
  judgement.laser_class = class_of(eye, far, visible(laser.wavelength_nm));
  return judgement;
}

}  // namespace biteline::optics
