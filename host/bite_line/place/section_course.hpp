// SPDX-License-Identifier: MIT
#pragma once
/// \file The line's course by the sections of one set of points: its height, and how far out it lies.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/bite_line/place/ridge.hpp"
#include "host/bite_line/place/sections.hpp"

namespace biteline::bite_line {

struct SectionCourseConfig {
  double along_mm{0.7};      ///< weights along the line, standard deviation
  double smoothing_mm{0.4};  ///< see PlacementConfig, as the two below
  double search_mm{2.5};
  double mean_mm{8.5};
  bool few{false};                          ///< see are_few()
  std::span<const double> upright_ratio{};  ///< per station, see section_curvature()
};

/// Per station, z in shoe, o from the outline that the sections are square to.
struct SectionCourse {
  Sections sections;
  Ridge ridge;
  std::vector<double> seen_z_mm;  ///< the section's own height
  std::vector<double> z_mm;       ///< bridged, and its running mean
  std::vector<double> row;        ///< of z_mm
  std::vector<double> o_mm;       ///< bridged by straight lines
  std::vector<std::uint8_t> o_known;
};

[[nodiscard]] SectionCourse section_course(const SectionPoints& points, std::span<const double> path_z_mm,
                                           const SectionCourseConfig& config);

/// How far out of the surface `whole` may lie at its own height where its points are few: standard deviation
/// per station, mm.  Each half of the points gives a surface of its own.  Half of their difference is the
/// noise of the whole.  Where the surface bends between points, chords across a hollow lie outside it, those
/// of both halves by more: so far their mean is off the whole, and the whole at most as far off the surface.
/// A half bridges what it does not see, as the whole would.  RMS of both over `config.mean_mm` of the line.
[[nodiscard]] std::vector<double> half_spread(const SectionInput& input, const SectionCourse& whole,
                                              const SectionCourseConfig& config);

/// Standard deviations per station, mm: outwards and up.
struct CourseSpread {
  std::vector<double> out_mm, up_mm;
};

/// How far `whole` may lie off because its sections are wide where points are few.  A section takes the
/// places beside it in, and to second order that moves it by half the line's bend times the variance along
/// the line.  Sections half as wide again move it by 1.25 times as much more, which tells.  A filled crease
/// jumps over a few millimetres, and both halves of the points miss that in the same way.
[[nodiscard]] CourseSpread width_spread(const SectionPoints& points, std::span<const double> path_z_mm,
                                        const SectionCourse& whole, const SectionCourseConfig& config);

}  // namespace biteline::bite_line
