// SPDX-License-Identifier: MIT
#pragma once
/// \file The shoe's surface with curvature, its feature points and their picture.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/bite_line/published/level_set.hpp"
#include "host/bite_line/published/unrolled.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::published {

struct CurvedSurface {
  std::vector<std::uint32_t> index;     ///< in the cloud
  std::vector<Eigen::Vector3f> points;  ///< in shoe
  Curvature curvature;                  ///< normals in shoe
};

/// The points of the outermost layer, every n-th when there are more than `limit`, with normals and
/// curvature.
[[nodiscard]] CurvedSurface curve_surface(const bite_line::Side& side, std::size_t limit,
                                          const CurvatureConfig& config);

struct FeatureConfig {
  float strong_per_mm{0.06F};  ///< mean curvature below minus this is concave: an edge rounded with 8 mm
  double speck_radius_mm{2.0};
  std::size_t speck_points{12};  ///< fewer feature points within the radius than this is a speck
};

[[nodiscard]] std::vector<std::uint32_t> feature_points(const CurvedSurface& surface,
                                                        const FeatureConfig& config);
/// Without specks.
[[nodiscard]] std::vector<std::uint32_t> denoised(const CurvedSurface& surface,
                                                  const std::vector<std::uint32_t>& features,
                                                  const FeatureConfig& config);

/// Picture of the denoised features' mean curvature; `known` tells where there is surface at all.
[[nodiscard]] Unrolled unroll_features(const CurvedSurface& surface,
                                       const std::vector<std::uint32_t>& features,
                                       const EightSections& sections);

}  // namespace biteline::published
