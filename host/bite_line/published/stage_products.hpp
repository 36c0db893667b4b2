// SPDX-License-Identifier: MIT
#pragma once
/// \file method.md 6 to 8 and 10: curvature, features, the eight-section picture, the thick and the thinned
/// line.

#include <span>
#include <vector>

#include "host/bite_line/published/surface.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// Points and pictures of the stages, and the thick line around `path_row`.
struct Stages {
  CurvedSurface surface;
  std::vector<std::uint32_t> features;
  std::vector<std::uint32_t> denoised_features;
  EightSections sections;
  Unrolled picture;
};

[[nodiscard]] Stages run_stages(const Side& side, const ExtractConfig& config, StageClock& clock);

/// The article's Figure 12: the feature points that its plain SVD (no levels, no weights) finds at the
/// surface that run_stages() chooses.
[[nodiscard]] std::vector<std::uint32_t> plain_svd_features(const Side& side, const ExtractConfig& config);

/// The article's last steps: back to 3-D, thinning, sequence.  Thick points wander across the groove, so the
/// line through each must be fitted over several millimetres: lambda grows with the points per millimetre.
[[nodiscard]] std::vector<Vec3> thin_line(const Stages& stages, std::span<const float> path_row,
                                          std::vector<std::uint32_t>& coarse);

/// Row of the eight-section picture for every column that the line passes, straight in between.
[[nodiscard]] std::vector<float> row_per_column(const cloud::ClosedLine& line, const SE3& T_base_shoe,
                                                const Unrolled& picture, const EightSections& sections);

/// Moves everything into the products; `cloud` is the one that the side was made of.
void hand_on(Stages&& stages, Products& products, const cloud::PointCloud& cloud, const SE3& T_base_shoe,
             std::vector<float> path_row);

}  // namespace biteline::bite_line
