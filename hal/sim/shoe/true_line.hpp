// SPDX-License-Identifier: MIT
#pragma once
/// \file The true bite line of a made shoe, by the definition of its place (README, "Words"; method: Words).

#include <functional>
#include <span>
#include <vector>

#include "hal/sim/shoe/made_shoe.hpp"

namespace biteline::sim {

/// The definition's own numbers.
struct PlaceDefinition {
  double smoothing_sigma_mm{0.4};  ///< Gaussian in height
  double search_mm{2.5};           ///< largest curvature is sought so far from the nominal path
  double running_mean_mm{8.5};     ///< along the line, the definition says 7 to 10
  double height_step_mm{0.02};     ///< of the search, refined by a parabola
  double normal_low_mm{2};         ///< normals are averaged between these heights above the line
  double normal_high_mm{6};
};

struct TrueLinePoint {
  Vec3 point_shoe{Vec3::Zero()};
  Vec3 normal_shoe{Vec3::Zero()};  ///< outward normal of the surface, averaged above the line
  double s_mm{0};
  double crease_per_mm{0};  ///< largest curvature of the smoothed section: how plain the line is to see here
};

/// Curvature of o(z) smoothed by the Gaussian, at evenly spaced heights within the search.
struct SmoothedSection {
  double first_z_mm{0};
  double step_mm{0};
  std::vector<double> curvature_per_mm{};  ///< o'' / (1 + o'^2)^1.5
};

/// `offset_mm` maps a height z in mm to o(z).
[[nodiscard]] SmoothedSection smoothed_section(const std::function<double(double)>& offset_mm,
                                               double nominal_z_mm, const PlaceDefinition& definition);

/// Largest curvature of each section, then the running mean along the closed line: the line's heights.
struct LineHeights {
  std::vector<double> z_mm;
  std::vector<double> crease_per_mm;  ///< largest curvature at each place, before the running mean
};
[[nodiscard]] LineHeights line_heights(const std::vector<SmoothedSection>& sections, double spacing_mm,
                                       const PlaceDefinition& definition);

/// Closed, anticlockwise, evenly spaced along the outline (`spacing_mm` is met to the whole number of
/// points). Empty for a bare upper and for a thing: they have no line.
[[nodiscard]] std::vector<TrueLinePoint> true_line(const MadeShoe& shoe, double spacing_mm,
                                                   const PlaceDefinition& definition = {});

/// The sample's line carried over to its bare upper: same outline place, same height.
[[nodiscard]] std::vector<TrueLinePoint> carried_line(std::span<const TrueLinePoint> sample_line,
                                                      const MadeShoe& upper);

}  // namespace biteline::sim
