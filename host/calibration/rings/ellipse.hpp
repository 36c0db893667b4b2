// SPDX-License-Identifier: MIT
#pragma once
/// \file Ellipses: direct fit to points, and the true projected centre of two concentric circles.

#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"

namespace biteline::calibration {

/// An ellipse in any plane of coordinates (pixels or normalised).
struct Ellipse {
  Vec2 centre{Vec2::Zero()};
  double major_semi{0};
  double minor_semi{0};
  double angle_rad{0};  ///< of the major axis from x towards y

  [[nodiscard]] Vec2 at(double phase_rad) const;
  /// Outward unit normal at a phase.
  [[nodiscard]] Vec2 normal_at(double phase_rad) const;
  /// First-order distance of a point from the curve, positive outside.
  [[nodiscard]] double distance(const Vec2& point) const;
  /// Symmetric C with (x, y, 1) C (x, y, 1)^T = 0 on the curve and < 0 inside.
  [[nodiscard]] Mat3 conic() const;
  [[nodiscard]] static std::optional<Ellipse> from_conic(const Mat3& conic);
};

/// Direct least-squares fit (Halir and Flusser 1998), then Gauss-Newton on the first-order distances. Nothing
/// for fewer than 6 points or when they lie on no ellipse.
[[nodiscard]] std::optional<Ellipse> fit_ellipse(std::span<const Vec2> points);

struct RobustEllipse {
  Ellipse ellipse;
  std::vector<char> kept;    ///< per point
  double rms{0};             ///< of the kept points' distances
  double coverage_ratio{0};  ///< share of 36 equal sectors that hold a kept point
};

/// As fit_ellipse(), leaving out points farther than 3 robust standard deviations, until nothing changes.
/// `floor` keeps points that are closer than that, whatever the spread.
[[nodiscard]] std::optional<RobustEllipse> fit_ellipse_robustly(std::span<const Vec2> points, double floor);

struct ConcentricCentre {
  Vec2 centre{Vec2::Zero()};  ///< image of the circles' common centre
  double diameter_ratio{0};   ///< inner to outer diameter, as seen
};

/// Image of the common centre of two concentric circles from their two ellipses.  C_outer^-1 C_inner has the
/// eigenvalues (1, 1, r_inner^2 / r_outer^2 up to scale); the single one's eigenvector is the centre (Kim,
/// Gurdjos, Kweon 2005, "Geometric and algebraic constraints of projected concentric circles").  Exact under
/// perspective, where the ellipses' own centres are not.
[[nodiscard]] std::optional<ConcentricCentre> concentric_centre(const Ellipse& outer, const Ellipse& inner);

/// Ellipse of a circle in the target's plane z = 0.  `H` maps (x, y, 1) of that plane to image coordinates.
[[nodiscard]] std::optional<Ellipse> project_circle(const Mat3& H, const Vec2& centre_mm, double radius_mm);

}  // namespace biteline::calibration
