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

/// A ball in a scan, as VDI/VDE 2634 part 2 judges it.
struct BallFit {
  Vec3 centre{Vec3::Zero()};
  PieceSize size{};
  double form_mm{0};  ///< range of the points' distances from the fitted ball: probing error of form
};
/// As measure_ball(); `within_mm` of the ball a point is of it.  Of the range 3 points in 1000 are left out,
/// the farthest ones, as the guideline allows.
[[nodiscard]] Result<BallFit> fit_ball(std::span<const Vec3> points, double diameter_mm, double within_mm);

/// Two equal balls at a known distance.
struct Bar {
  double diameter_mm{0}, distance_mm{0};
};
struct BarFit {
  double distance_mm{0};  ///< of the balls' middles
  double sigma_mm{0};     ///< of it, from the points' own scatter
  std::size_t points{0};
};
/// Errc::Refused: fewer than two such balls, or at another distance altogether.
[[nodiscard]] Result<BarFit> measure_bar(std::span<const Vec3> points, const Bar& bar);

/// The plane that most points lie on.
struct FlatFit {
  double flatness_mm{0};  ///< range of the points' distances from it, 3 in 1000 left out
  double rms_mm{0};
  double across_mm{0};  ///< how far it reaches: of its box in its own longest direction
  std::size_t points{0};
};
[[nodiscard]] Result<FlatFit> measure_flat(std::span<const Vec3> points, double within_mm);

/// The distance of two parallel planes near the wanted height, at the points' places.
/// Errc::Refused: fewer than two such planes.
[[nodiscard]] Result<PieceSize> measure_step(std::span<const Vec3> points, double height_mm);

}  // namespace biteline::capture
