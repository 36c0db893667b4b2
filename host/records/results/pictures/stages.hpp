// SPDX-License-Identifier: MIT
#pragma once
/// \file stages/: what every stage of the extraction saw, as pictures and as clouds.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/core/result.hpp"
#include "host/bite_line/extraction.hpp"
#include "host/bite_line/line_stages.hpp"

namespace biteline::results {

/// Writes into `folder` (made when missing), replacing an earlier run's files:
/// 1_point_cloud, 2_feature_points, 3_denoised, 4_coarse_line, 5_thinned_line, 6_sequence (each .png and
/// .ply) and unrolled_curvature.png.  A refused extraction has the stages that it reached; the others are
/// left out, and removed.
[[nodiscard]] Result<void> write_stages(const std::filesystem::path& folder,
                                        const bite_line::LineStages& stages,
                                        const bite_line::Extraction& extraction);

/// The pictures that `folder` holds, in the order of the stages: file name and what it shows.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> pictures(const std::filesystem::path& folder);

}  // namespace biteline::results
