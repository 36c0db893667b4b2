// SPDX-License-Identifier: MIT
#pragma once
/// \file The published steps between the side and the traced picture, and behind it: curvature, features, the
/// eight-section picture, the thick and the thinned line.

#include <span>
#include <vector>

#include "host/bite_line/published/surface.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::published {

struct Config {
  double point_spacing_mm{0.5};              ///< of the resulting line
  double curvature_radius_mm{1.5};           ///< neighbourhood of normals and curvature
  std::size_t surface_point_limit{250'000};  ///< denser clouds are thinned to about this
};

struct Features {
  CurvedSurface surface;
  std::vector<std::uint32_t> strong;    ///< strongly concave
  std::vector<std::uint32_t> denoised;  ///< without specks
  EightSections sections;
  Unrolled picture;  ///< of the denoised ones
};

[[nodiscard]] Features find_features(const bite_line::Side& side, const Config& config);

/// The feature points that a plain SVD (no levels, no weights) finds at the surface that find_features()
/// chooses: what the published weighted PCA is compared with.
[[nodiscard]] std::vector<std::uint32_t> plain_svd_features(const bite_line::Side& side,
                                                            const Config& config);

/// Back to 3-D: the feature points around `path_row`, ordered along it.
[[nodiscard]] std::vector<std::uint32_t> coarse_line(const Features& features,
                                                     std::span<const float> path_row);

/// Thick points wander across the groove, so the line through each must be fitted over several millimetres:
/// lambda grows with the points per millimetre.
[[nodiscard]] std::vector<Vec3> thin_line(const Features& features, std::span<const std::uint32_t> coarse);

}  // namespace biteline::published
