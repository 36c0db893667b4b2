// SPDX-License-Identifier: MIT
#pragma once
/// \file What noise a head's stripe will have, and what limits it: closed forms, before anything is built.

#include "common/optics/speckle.hpp"

namespace biteline::optics {

/// A head and how it scans.  Defaults: the simulated cell's.
struct ScanLight {
  double f_number{SpeckleOptics{}.f_number};
  double focal_mm{12};
  double distance_mm{200};  ///< from the lens to the stripe, along its axis
  double pixel_um{SpeckleOptics{}.pixel_um};
  double wavelength_nm{SpeckleOptics{}.wavelength_nm};
  double angle_rad{0.785398163};  ///< between laser plane and camera axis
  double stripe_mm{0.45};         ///< the sheet's thickness at its waist, full width at half height
  double range_mm{33};            ///< heights that are to be seen
  double exposure_us{400};
  double speed_mm_s{100};  ///< of the surface, across the stripe
  double grey{120};        ///< of the stripe's middle over the dark
  double electrons_per_grey{40};
  double read_noise_grey{0.5};
  double laser_mw{5};    ///< all of the line
  double fan_rad{0.84};  ///< full angle of the line
};

[[nodiscard]] SpeckleOptics speckle_optics(const ScanLight& light);

/// Of a height, along the laser plane: one row of the picture.
[[nodiscard]] double row_mm(const ScanLight& light);

/// What the noise of one column's point is made of, standard deviations, for a matt surface that depolarises.
struct StripeNoise {
  double contrast{0}, contrast_at_rest{0};  ///< of one pixel, with the motion within the exposure and without
  double moved_mm{0};                       ///< within the exposure
  double stripe_px{0};                      ///< width in the middle: standard deviation
  double end_stripe_px{0};                  ///< and at the range's ends, where it is out of focus
  double speckle_mm{0}, end_speckle_mm{0};
  double camera_mm{0};             ///< photons and read-out
  double pixel_mm{0};              ///< the pixels' steps: largest error of a centre of gravity
  double middle_mm{0}, end_mm{0};  ///< all of them, in the middle and at the range's ends
  double dorsch_mm{0};             ///< of one bright spot that is no wider than the lens makes it
};

/// Sources: Dorsch, Haeusler, Herrmann, Applied Optics 33, 1306 (1994), for the limit.  Noise of a centre of
/// gravity in light of contrast C whose grain is L rows, on a Gaussian of standard deviation s:
/// C sqrt(L s / (4 sqrt(pi))).  Photons: s over the root of their number; read noise: Cramer and Rao's bound,
/// 2 s r^2 / (sqrt(pi) A^2).  Pixels: exp(-2 (pi s)^2) / pi, the first harmonic of a sampled Gaussian.  Out
/// of focus: a disc of f^2 d / (N (Z - f) (Z + d)), d along the axis; its standard deviation is a quarter.
/// The sheet widens to the range's ends as a Gaussian beam whose waist is in the middle.  Aberrations of the
/// lens are left out.
[[nodiscard]] StripeNoise stripe_noise(const ScanLight& light);

enum class NoiseLimit { Speckle, Camera, Pixels, Motion, DepthOfField };
/// Motion: the surface moves farther within the exposure than the sheet is thick.  Depth of field: the ends'
/// noise is half again the middle's.  Else the largest part.
[[nodiscard]] NoiseLimit limit_of(const ScanLight& light, const StripeNoise& noise);

/// The same brightness through another stop or with another laser power: the exposure follows.
[[nodiscard]] ScanLight with_f_number(const ScanLight& light, double f_number);
[[nodiscard]] ScanLight with_laser_mw(const ScanLight& light, double laser_mw);
/// Likewise with another thickness of the sheet.
[[nodiscard]] ScanLight with_stripe_mm(const ScanLight& light, double stripe_mm);

}  // namespace biteline::optics
