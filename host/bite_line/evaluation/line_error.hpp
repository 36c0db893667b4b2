// SPDX-License-Identifier: MIT
#pragma once
/// \file How far a result's line lies from the true one.

#include <optional>

#include "host/bite_line/evaluation/reference_surface.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::evaluation {

/// Distances both ways: each true point to the result's polyline and each result point to the true polyline,
/// both closed.
struct LineError {
  double mean_mm{0};
  double p95_mm{0};
  double max_mm{0};
  double complete{0};                    ///< share of the true length with a result within 1 mm
  std::optional<double> normal_rms_deg;  ///< see normal_error_deg()
  SE3 T_truth_line{SE3::Identity()};     ///< the alignment applied; identity without one
};

[[nodiscard]] LineError line_error(const cloud::ClosedLine& result, const cloud::ClosedLine& truth);

/// After the best rigid alignment of the result to the truth (ICP on the polylines).
[[nodiscard]] LineError line_error_aligned(const cloud::ClosedLine& result, const cloud::ClosedLine& truth);

/// RMS angle between the result's normals and the true surface's normal averaged from 2 to 6 mm above the
/// line, in the section by the upright plane along the outline's normal.  `up` is the shoe's z.  Nothing when
/// the surface is not met at more than half of the points.
[[nodiscard]] std::optional<double> normal_error_deg(const cloud::ClosedLine& result,
                                                     const ReferenceSurface& surface, const Vec3& up);

}  // namespace biteline::evaluation
