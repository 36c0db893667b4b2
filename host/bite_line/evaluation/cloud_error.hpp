// SPDX-License-Identifier: MIT
#pragma once
/// \file How far a cloud lies from the true surface.

#include "host/bite_line/evaluation/reference_surface.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::evaluation {

/// Signed distances along the surface's outward normal, mm; names as in the method's Table 1.
struct CloudError {
  double mean_mm{0};
  double rms_mm{0};
  double mean_positive_mm{0};
  double mean_negative_mm{0};
  double q001_mm{0};  ///< 0.1 % quantile
  double q999_mm{0};  ///< 99.9 % quantile
  double min_mm{0};
  double max_mm{0};
  std::size_t points{0};                 ///< measured
  std::size_t points_far{0};             ///< no surface within reach: left out of all figures above
  SE3 T_surface_cloud{SE3::Identity()};  ///< the alignment applied; identity without one
};

/// Points farther than this from any surface belong to the table or a fixture that the reference does not
/// show.
inline constexpr double k_surface_reach_mm = 5.0;

[[nodiscard]] CloudError cloud_error(const cloud::PointCloud& cloud, const ReferenceSurface& surface);

/// After the best rigid alignment: least squares of the point-to-surface distances (Gauss-Newton, point to
/// plane), on an even subset of at most 50 000 points, starting from the cloud as it stands.
[[nodiscard]] CloudError cloud_error_aligned(const cloud::PointCloud& cloud, const ReferenceSurface& surface);

}  // namespace biteline::evaluation
