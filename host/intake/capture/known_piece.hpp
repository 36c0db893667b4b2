// SPDX-License-Identifier: MIT
#pragma once
/// \file A piece of known size in a scan: what the scan makes of it.

#include <span>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::capture {

struct PieceSize {
  double size_mm{0};   ///< a ball's diameter, a step's height
  double sigma_mm{0};  ///< of it, from the points' own scatter
  double rms_mm{0};    ///< of the points about the fitted surface
  std::size_t points{0};
};

/// The sphere that most points lie on, near the wanted diameter; all else in the cloud may be there too.
/// Errc::Refused: no such ball, or too small a cap of it to tell its diameter.
[[nodiscard]] Result<PieceSize> measure_ball(std::span<const Vec3> points, double diameter_mm);

/// The distance of two parallel planes near the wanted height, at the points' places.
/// Errc::Refused: fewer than two such planes.
[[nodiscard]] Result<PieceSize> measure_step(std::span<const Vec3> points, double height_mm);

}  // namespace biteline::capture
