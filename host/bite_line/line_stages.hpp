// SPDX-License-Identifier: MIT
#pragma once
/// \file What the steps handed on, as clouds and as a picture of the side: for people to look at.

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/workings.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::bite_line {

/// The shoe's side unrolled.  Row 0 is the top; left and right end are the same place of the shoe.
struct UnrolledSide {
  int rows{0};
  int cols{0};
  std::vector<float> curvature_per_mm;  ///< row-major, convex > 0; 0 where unknown
  std::vector<unsigned char> known;     ///< 1 where the surface was seen
  struct Mark {
    int col;
    std::string name;
  };
  std::vector<Mark> marks;                     ///< places along the outline that have a name
  std::vector<float> path_row;                 ///< of the line, per column; negative or empty: none
  std::vector<std::vector<float>> rival_rows;  ///< the same of what was not taken

  [[nodiscard]] std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
};

/// Indices point into `surface`.
struct LineStages {
  cloud::PointCloud surface;                   ///< the shoe's outermost layer, base, with normals
  std::vector<float> curvature_per_mm;         ///< per point, convex > 0
  std::vector<std::uint32_t> feature_points;   ///< strongly concave
  std::vector<std::uint32_t> denoised_points;  ///< those of which a closed line can be made
  /// Of the published method only: the feature points of its plain SVD, which its weighted PCA is measured
  /// against.
  std::vector<std::uint32_t> plain_svd_features;
  std::vector<std::uint32_t> coarse_line;  ///< thick: those around the path
  std::vector<Vec3> thinned_line;          ///< base: the coarse line's middle, in order
  UnrolledSide unrolled;
};

/// What find_bite_line() did.  The curvature is that of its height field: of the upright sections, where the
/// side turns by an angle over 0.75 mm of height.
[[nodiscard]] LineStages line_stages(const Workings& workings);

}  // namespace biteline::bite_line
