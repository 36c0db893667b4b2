// SPDX-License-Identifier: MIT
#pragma once
/// \file A target on a sheet, to be printed to scale.

#include <string>
#include <vector>

#include "host/calibration/rings/target.hpp"

namespace biteline::calibration {

/// Millimetres from the sheet's upper left corner, y downwards.
struct TargetSheet {
  struct Ring {
    double x_mm{0}, y_mm{0};  ///< centre
  };
  /// Of a chessboard, black.
  struct Square {
    double x_mm{0}, y_mm{0};  ///< upper left corner
  };
  struct Stroke {
    double x0_mm{0}, y0_mm{0}, x1_mm{0}, y1_mm{0};
    bool dashed{false};
  };
  struct Words {
    double x_mm{0}, y_mm{0};  ///< left end of the base line
    std::string text;         ///< printable ASCII
  };
  double width_mm{0}, height_mm{0};
  double ring_radius_mm{0}, ring_stroke_mm{0};  ///< of the middle of the printed ring
  std::vector<Ring> rings;
  double square_mm{0};
  std::vector<Square> squares;
  std::vector<Stroke> strokes;  ///< the ruler of 50 mm; with two planes where to cut
  std::vector<Words> words;     ///< the whole caption
};

/// Two planes: two grids side by side, to be cut apart and glued to two plates.
[[nodiscard]] TargetSheet target_sheet(const RingTarget& target);

/// PDF 1.4 of one page as large as the sheet.  Rings are eight Bezier arcs each: off by a millionth of the
/// radius, where the four of most programs are off by 0.03 %.
[[nodiscard]] std::string target_pdf(const RingTarget& target);

/// As read_target() reads it.
[[nodiscard]] std::string target_text(const RingTarget& target);

}  // namespace biteline::calibration
