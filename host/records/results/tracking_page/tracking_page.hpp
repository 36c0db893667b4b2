// SPDX-License-Identifier: MIT
#pragma once
/// \file Virtual tracking: one self-contained page in which the arm follows its path.

#include <filesystem>

#include "host/robot/path/plan.hpp"
#include "host/robot/path/track.hpp"

namespace biteline::results {

struct Scene {
  const path::PlannedPath& path;
  const kinematics::ArmModel& arm;
  const path::Tool& tool;
  std::vector<Vec3> shoe_points_base;  ///< at most `k_most_points` of them are shown
  bool shoe_is_guessed{true};          ///< from the line, not scanned
  double table_z_mm{0};
  std::vector<path::TrackSample> track;  ///< recorded, may be empty; time from its begin
};

constexpr std::size_t k_most_points = 30000;

/// Arm, tool, shoe and line in 3-D with play, pause and scrub; joints, joint speeds, tip speed and distances
/// as plots. Without WebGL the page says so and shows the plots.  Written beside and renamed.
[[nodiscard]] Result<void> write_tracking_page(const std::filesystem::path& file, const Scene& scene);

}  // namespace biteline::results
