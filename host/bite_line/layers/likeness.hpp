// SPDX-License-Identifier: MIT
#pragma once
/// \file How much the rows of one column of the side look like the bite line, in vector lanes.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace biteline::bite_line {

/// Lengths in rows.
struct LikenessConfig {
  double row_mm;
  double crease_rad;  ///< see EvidenceConfig, as all that follows
  int crest;
  double one_surface_ratio;
  double flank_soft_rad;
  double rad_per_step_mm;
  int near_from, near_to;      ///< of what may hang over, above and below
  int flank_from, flank_to;    ///< of the two surfaces
  int rim_from{0}, rim_to{0};  ///< of a rim below, where the lower surface ends; 0: as if there were none
  double rim_rad{0};           ///< that the surface turns outwards there
};

class ColumnLikeness {
 public:
  ColumnLikeness(const LikenessConfig& config, std::size_t rows);

  /// Room for the turn along a crease, per row.
  [[nodiscard]] std::span<float> turn_rad() { return {turn_rad_.data() + margin_, rows_}; }
  /// Of the column whose turns are there now; `o_mm` counts where it was `seen`.  Turns below `noise_rad` are
  /// nothing.  Good until the next call.
  [[nodiscard]] std::span<const float> of(const float* o_mm, const std::uint8_t* seen, double noise_rad);

  static constexpr std::size_t k_most_lanes = 16;
  /// What the vector code works on.  Sums over the rows below each, from `margin` below the lowest row on, so
  /// that a straight line through any rows takes two look-ups.
  struct Table {
    const float* turn_rad;  ///< of row 0
    const double *n, *z_mm, *zz, *o_mm, *zo;
    double noise_rad;
  };

 private:
  void see_rims(const float* o_mm, const std::uint8_t* seen, double noise_rad);
  LikenessConfig config_;
  std::size_t rows_;
  std::size_t margin_;
  std::vector<float> turn_rad_;
  std::vector<double> n_, z_mm_, zz_, o_mm_, zo_;
  std::vector<float> likeness_;
};

}  // namespace biteline::bite_line
