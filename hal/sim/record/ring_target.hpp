// SPDX-License-Identifier: MIT
#pragma once
/// \file Sheets with a grid of rings or a chessboard, and pictures of them: what heads are calibrated with.

#include <cstdint>
#include <span>
#include <vector>

#include "common/image/grey_image.hpp"
#include "hal/sim/render/made_head.hpp"

namespace biteline::sim {

/// Black rings on white, mm; or a chessboard whose inner corners lie where the rings' centres do.
struct RingGrid {
  int rows{4};
  int cols{7};
  double pitch_mm{14};
  double outer_diameter_mm{12};
  double inner_diameter_mm{6};
  double margin_mm{9};     ///< white beyond the outermost centres
  bool chessboard{false};  ///< its upper left square is black

  [[nodiscard]] double width_mm() const { return (cols - 1) * pitch_mm + 2 * margin_mm; }
  [[nodiscard]] double height_mm() const { return (rows - 1) * pitch_mm + 2 * margin_mm; }
  /// Sheet frame: origin in the middle, x along the columns, y along the rows (down), z away from the viewer.
  [[nodiscard]] Vec3 centre(int row, int col) const {
    return {(col - 0.5 * (cols - 1)) * pitch_mm, (row - 0.5 * (rows - 1)) * pitch_mm, 0};
  }
  /// Of the same extent, with a corner where each ring's centre is and `squares` squares from one to the
  /// next.
  [[nodiscard]] RingGrid as_chessboard(int squares) const {
    RingGrid board = *this;
    board.chessboard = true;
    board.rows = (rows - 1) * squares + 1;
    board.cols = (cols - 1) * squares + 1;
    board.pitch_mm = pitch_mm / squares;
    board.margin_mm = 1.3 * board.pitch_mm;  // a square, and some white
    return board;
  }
};

struct PlacedGrid {
  RingGrid grid;
  SE3 T_cam_sheet{SE3::Identity()};
};

/// Lamp of uneven light, lens blur, shot and read noise.
struct LampLight {
  double white_grey{205};
  double black_ratio{0.14};
  double background_ratio{0.27};
  double slope_ratio{0.25};  ///< light changes by this much across the picture
  double slope_rad{0.6};     ///< in this direction
  /// The picture is filled from one of this size, nearest pixel, as a camera's or a driver's scaler does.
  double scaled_ratio{1};
};

/// The full sensor's picture of the sheets; where several lie on one ray the nearest is seen.
/// Edges are exact to some 0.01 px (samples 6 x 6, of a chessboard 89, in every pixel that an edge crosses).
[[nodiscard]] image::GreyImage render_rings(const MadeHead& head, std::span<const PlacedGrid> sheets,
                                            const LampLight& light, std::uint64_t noise_seed);

/// Every ring lies in the picture, `margin_px` from its border.
[[nodiscard]] bool all_rings_visible(const MadeHead& head, const PlacedGrid& sheet, double margin_px);

}  // namespace biteline::sim
