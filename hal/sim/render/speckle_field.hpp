// SPDX-License-Identifier: MIT
#pragma once
/// \file The grain of a coherent laser's light in the picture, by wave optics.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/optics/speckle.hpp"

namespace biteline::sim {

/// Random phases seen through a round pupil, their brightness counted over square pixels: a field of
/// k_columns x k_rows pixels that goes on without a seam, for two polarisations, each of mean 1.  At half
/// pixels, too.  Aberrations and focus move no grain's size or contrast, so there are none here.
///
/// Immutable after build().  Thread: any.  Memory: 4 MB.
class SpeckleField {
 public:
  static constexpr int k_columns = 512, k_rows = 256;

  /// One for each optics in a process, kept: the first takes a few tenths of a second.
  /// Pre: f-number at least 2, so that four samples a pixel hold the field.
  [[nodiscard]] static std::shared_ptr<const SpeckleField> of(const optics::SpeckleOptics& optics);

  /// Where in the field a picture's first pixel lies, in half pixels.
  struct Place {
    int column_half_px{0}, row_half_px{0};
  };
  /// Adds, for each of the rows from `first_row` on, the brightness of both polarisations.
  struct Grain {
    float along{0}, across{0};  ///< the polarisation of the laser, and the other one
  };
  struct Pixel {
    int column{0}, first_row{0};
  };
  void add(const Place& place, const Pixel& pixel, std::span<Grain> rows) const;

  explicit SpeckleField(const optics::SpeckleOptics& optics);

 private:
  /// By half pixel (2 x 2), column, row.
  std::array<std::vector<Grain>, 4> grains_;
};

}  // namespace biteline::sim
