// SPDX-License-Identifier: MIT
#pragma once
/// \file Speckle of a laser's light on a rough surface, as a lens and a pixel show it.
///
/// Sources: Goodman, Speckle Phenomena in Optics (2007), chapters 4 (a detector's area), 3.4 (polarisation)
/// and 6.3 (width of the spectrum); Dorsch, Haeusler, Herrmann, Applied Optics 33, 1306 (1994).

namespace biteline::optics {

/// What makes the grain.
struct SpeckleOptics {
  double f_number{5.6};          ///< of the lens, focused far away
  double magnification{0.0638};  ///< picture over object: f / (distance - f)
  double pixel_um{4.4};          ///< pitch; the pixel's light is counted over a square of this side
  double wavelength_nm{660};

  friend bool operator==(const SpeckleOptics&, const SpeckleOptics&) = default;
};

/// Sine of half the cone that the lens takes of an object's point: m / (2 N (1 + m)).
[[nodiscard]] double aperture_sine(const SpeckleOptics& optics);

/// The grain in the picture: from the middle to the first place without likeness, 1.22 lambda N (1 + m).
[[nodiscard]] double grain_um(const SpeckleOptics& optics);

/// Likeness of the light at two places of the picture `apart_um` apart (coherence factor of a round pupil,
/// squared): 1 at 0, 0 at grain_um().
[[nodiscard]] double likeness(const SpeckleOptics& optics, double apart_um);

/// Contrast (standard deviation over mean) of what one pixel counts, of light of one polarisation, while the
/// surface's picture moves by `moved_px` down the column: 1 / sqrt(M), Goodman's M of pixel and motion.
[[nodiscard]] double pixel_contrast(const SpeckleOptics& optics, double moved_px = 0);

/// Sum over rows of the likeness of what pixels count at the same column, at rest: the grain as pixels have
/// it; 1 where each row has its own.
[[nodiscard]] double rows_per_grain(const SpeckleOptics& optics);

/// Share of the contrast that stays where the surface keeps this share of the laser's polarisation: from
/// 1 / sqrt(2) at 0 to 1 at 1.
[[nodiscard]] double polarised_contrast(double polarised_ratio);

/// Share of the contrast that stays where the light's paths differ by this (standard deviation, there and
/// back), for a line of this width (full width at half height, Gaussian).
struct Paths {
  double spread_mm{0};
  double line_width_nm{0};
};
[[nodiscard]] double spectral_contrast(const SpeckleOptics& optics, const Paths& paths);

/// Dorsch's limit of a bright spot's place, on the object and across the line of sight:
/// C lambda / (2 pi sin u).
[[nodiscard]] double dorsch_limit_um(const SpeckleOptics& optics, double contrast);

}  // namespace biteline::optics
