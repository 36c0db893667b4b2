// SPDX-License-Identifier: MIT
#pragma once
/// \file The ring grid or chessboard: what is printed, as target.yaml tells it.

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::calibration {

enum class TargetKind : std::uint8_t { Rings, Chessboard };

/// Dark rings on a bright plane, or a chessboard, whose inner corners then stand for the rings.  Target
/// frame: origin at the first ring's centre, x along a row, y along a column, z into the plane, away from a
/// camera that looks at its printed side.
struct RingTarget {
  int rows{0};
  int cols{0};
  double pitch_mm{0};
  double outer_diameter_mm{0};
  double inner_diameter_mm{0};
  int planes{1};                       ///< grids of this kind on the target; 2 for the laser's
  TargetKind kind{TargetKind::Rings};  ///< a chessboard has no diameters
  bool first_is_white{false};          ///< of a chessboard: its upper left square

  [[nodiscard]] bool chessboard() const { return kind == TargetKind::Chessboard; }
  /// What a person calls its marks.
  [[nodiscard]] const char* marks() const { return chessboard() ? "corners" : "rings"; }
  [[nodiscard]] int rings() const { return rows * cols; }
  [[nodiscard]] Vec3 ring_target(int row, int col) const { return {col * pitch_mm, row * pitch_mm, 0}; }
  /// Middle of the grid.
  [[nodiscard]] Vec3 middle_target() const {
    return {(cols - 1) * pitch_mm / 2, (rows - 1) * pitch_mm / 2, 0};
  }
};

/// Faults name the file, the key and what was expected.
[[nodiscard]] Result<RingTarget> read_target(const std::filesystem::path& file);

/// A drawing of its grids to print to scale, with a ruler of 50 mm to check the printer by.
[[nodiscard]] std::string target_svg(const RingTarget& target);

}  // namespace biteline::calibration
