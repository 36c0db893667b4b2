// SPDX-License-Identifier: MIT
#pragma once
/// \file Laser-line extraction: sub-pixel rows per image column.

#include <cstdint>
#include <memory>
#include <span>

#include "common/core/result.hpp"
#include "common/rt/annotations.hpp"
#include "common/stripe/peaks.hpp"

namespace biteline::stripe {

enum class PeakMode : std::uint8_t {
  Matched,          ///< weighted least squares of the stripe's shape: the noise limit; the default
  Maximum,          ///< brightest pixel, parabola through its neighbours
  Threshold,        ///< mean of the two edges at half height
  CentreOfGravity,  ///< first moment over the run above a tenth of the height
  FirZeroCrossing,  ///< zero of the smoothed first derivative
};

/// Variance of one pixel at mean grey value m: read^2 + gain m + (speckle m)^2.  Speckle is measured in each
/// picture (Peaks::speckle); what is told here is taken where too few columns show it, and no peak is judged
/// as if there were less.
struct NoiseModel {
  float read_noise_grey{0.8F};          ///< of the camera, quantisation (0.29) included
  float gain_grey_per_electron{0.02F};  ///< full scale at some 12 000 electrons: a CCD of the sensor's kind
  float speckle_contrast{0.1F};         ///< per pixel, after the optics have averaged over grains
  /// Rows that share their speckle: the optics' blur in pixels.  1: every pixel its own.
  float speckle_grain_px{2.9F};
  /// So much is believed at least, however even the light: a colour filter's interpolation and JPEG smooth
  /// the light along a stripe, and not its place.  0: what is measured.
  float speckle_contrast_min{0};
};

struct PeakConfig {
  PeakMode mode{PeakMode::Matched};
  float threshold_grey{12.0F};  ///< a peak is at least this high above its background
  float width_min_px{1.5F};     ///< full width at half maximum; narrower ones may be missed, or are flagged
  float width_max_px{24.0F};
  NoiseModel noise{};
};

/// A frame's pixels as the extractor sees them; rows `stride_bytes` apart.
struct PixelView {
  const std::uint8_t* pixels{nullptr};
  std::size_t stride_bytes{0};
  int height_px{0};  ///< 0: as given to create(); fewer where a camera's region follows the stripe
};

/// A lit frame without the room's own light: lit - dark + k_ambient_pedestal, saturated pixels kept at full
/// scale.  The pedestal keeps noise below zero; read noise counts twice in such a picture.
inline constexpr std::uint8_t k_ambient_pedestal = 8;

struct AmbientPair {
  PixelView lit;
  PixelView dark;  ///< the same region with the laser off
  int width_px{0};
  int height_px{0};
};

/// `out` has width x height pixels without padding.
void rt_subtract_ambient(const AmbientPair& pair, std::uint8_t* out) noexcept BITELINE_RT;

/// Finds the stripe's peaks in each column of 8-bit frames.
///
/// One row-major pass (vectors of columns, instruction set chosen at run time) looks for blocks of eight rows
/// with light in them; it reads only as many rows as a stripe of PeakConfig::width_min_px cannot hide
/// between: every second one by default, every one where narrower stripes are permitted (plan_search()).  The
/// maxima of such blocks are a small map in which candidates are searched, and only these are read closely.
/// Two stripes in one column are two peaks from 24 rows apart on, and mostly from 20 on.  Nearer ones are one
/// peak: at three to five of their standard deviations its shape is flagged k_peak_poor_fit; farther apart
/// one of the two is measured and the other not seen; nearer, their sum looks like one stripe between them.
/// Thread: one at a time.  RT: rt_extract.  Memory: all sized in create().
class PeakExtractor {
 public:
  /// Fails on more than k_max_columns columns, fewer than 16 columns or rows, or a config out of range.
  [[nodiscard]] static Result<PeakExtractor> create(const PeakConfig& config, int width_px, int height_px);

  PeakExtractor(PeakExtractor&&) noexcept;
  PeakExtractor& operator=(PeakExtractor&&) noexcept;
  ~PeakExtractor();

  /// Fills every column of `out`; a column without stripe has no peaks.  Pre: the view is as wide as given to
  /// create() and no taller, 16 rows at least.
  void rt_extract(const PixelView& frame, Peaks& out) noexcept BITELINE_RT;

  /// Changes places with another one; nothing is freed.
  void rt_swap(PeakExtractor& other) noexcept BITELINE_RT { state_.swap(other.state_); }

 private:
  struct State;
  explicit PeakExtractor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::stripe
