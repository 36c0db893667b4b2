// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a camera's columns and rows truly look, as the edges of many rings show it.

#include <array>
#include <span>
#include <vector>

#include "host/calibration/rings/detector.hpp"

namespace biteline::calibration {

/// Shift of each column along u and of each row along v against an even grid of pixels.
///
/// A picture that was scaled by sampling (a camera's or a driver's scaler) shows places up to half a pixel
/// off, in a pattern of columns and rows that every picture repeats; so does a sensor with stitched fields.
/// No lens model has it, and it puts every ring's centre off by some hundredths of a pixel.  All rings of all
/// pictures of one camera see it, with hundreds of edge points for each column.
class PixelGrid {
 public:
  /// False: an even grid, or none to be seen.
  [[nodiscard]] bool uneven() const { return !shift_px_[0].empty(); }
  /// Of the edges' squared distances from their ellipses, the share that the shifts tell in pictures that
  /// were not used to find them.
  [[nodiscard]] double explained_ratio() const { return explained_ratio_; }
  [[nodiscard]] double rms_px() const { return rms_px_; }  ///< of a shift, where edges lie

  /// Edges put where an even grid would have them, ellipses and centre fitted again; the ring itself where
  /// the grid is even.
  [[nodiscard]] Ring corrected(const Ring& ring) const;

 private:
  friend PixelGrid find_pixel_grid(std::span<const std::vector<Ring>> pictures);
  std::array<std::vector<double>, 2> shift_px_;  ///< per column, per row; empty when even
  double explained_ratio_{0};
  double rms_px_{0};
};

/// Ridge regression of the edges' distances from their own ellipses on the shifts, ellipses and shifts in
/// turn.  Only what is finer than a ring is looked for: the rest is the lens's.  The grid is taken for uneven
/// only when the shifts found from one half of the pictures tell the other half's edges.
[[nodiscard]] PixelGrid find_pixel_grid(std::span<const std::vector<Ring>> pictures);

}  // namespace biteline::calibration
