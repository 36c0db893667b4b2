// SPDX-License-Identifier: MIT
#pragma once
/// \file A small made session on disk: a head looking at a rippled floor, stripe rows known exactly.

#include <filesystem>
#include <vector>

#include "common/session/session.hpp"

namespace biteline::test {

struct MadeSession {
  int frames{12};
  int width_px{160};
  int height_px{96};
  std::uint32_t seed{1};
};

/// Row of the stripe's centre in the region, for a frame and a column.
[[nodiscard]] double made_row_px(const MadeSession& made, int frame, int column);

/// The head: lens distortion, a tilted laser plane and a mounting without symmetry, so that a swapped frame
/// shows.
[[nodiscard]] geometry::SensorModel made_sensor(const MadeSession& made);

/// T_base_flange at a frame's exposure; the stored poses lie on the same smooth motion.
[[nodiscard]] SE3 made_pose(int frame);

/// Writes the session's folder.
void write_made_session(const MadeSession& made, const std::filesystem::path& folder);

}  // namespace biteline::test
