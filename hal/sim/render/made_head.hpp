// SPDX-License-Identifier: MIT
#pragma once
/// \file A made scanning head: its true calibration, its light, and how its camera spoils the picture.

#include <cstdint>

#include "common/geometry/sensor_model.hpp"
#include "common/optics/speckle.hpp"

namespace biteline::sim {

struct LaserLight {
  Vec3 emitter_cam{Vec3::Zero()};  ///< in the laser plane
  Vec3 beam_cam{Vec3::UnitZ()};    ///< middle of the fan, unit, in the laser plane
  double fan_half_rad{0.42};
  double sigma_mm{0.19};  ///< half thickness of the sheet: standard deviation of its Gaussian
  /// Grey levels of the stripe's middle on a white (ratio 1) surface lit and seen head on at the working
  /// distance.
  double full_grey{380};
  double line_width_nm{0.5};  ///< of its spectrum, full width at half height
  bool coherent{true};        ///< false: a lamp behind a slit, whose light has no speckle
};

struct CameraFaults {
  double blur_px{1.1};            ///< standard deviation of lens and pixel
  double electrons_per_grey{40};  ///< full well of about 10 000 over 255 levels
  double read_noise_grey{0.5};
  double black_grey{0};
  double ambient_grey{0};  ///< at the nominal exposure
};

/// How the head hangs on the flange.
enum class Holder : std::uint8_t {
  Straight,  ///< as published: the beam leaves along the flange's z; no upright arm gets it round a shoe
  Bracket,   ///< the flange looks down from above the shoe, the head looks in from the side below it
};

/// The beam of a head on a bracket looks down by this much when the flange is upright.
inline constexpr double k_bracket_pitch_rad = 0.098;

struct MadeHead {
  geometry::SensorModel model;  ///< true values; exposure and rate are the nominal ones
  int sensor_width_px{1626};
  int sensor_height_px{1236};
  LaserLight laser;
  optics::SpeckleOptics optics;  ///< lens, pixel and the laser's wavelength; brightness does not follow them
  CameraFaults faults;
  double working_distance_mm{200};  ///< from the camera to the stripe, along its axis
};

/// What may be chosen of a head's light.  The stripe is as bright with any of it: laser and exposure follow.
struct HeadLight {
  double f_number{optics::SpeckleOptics{}.f_number};
  double wavelength_nm{optics::SpeckleOptics{}.wavelength_nm};
  double line_width_nm{LaserLight{}.line_width_nm};
  bool coherent{true};
};
void set_light(MadeHead& head, const HeadLight& light);

/// A head of the published build (1626 x 1236 pixels, laser and camera axis at 45 degrees), its measures
/// varied by seed as one built head differs from the next.
[[nodiscard]] MadeHead draw_head(std::uint64_t seed, Holder holder = Holder::Straight);

}  // namespace biteline::sim
