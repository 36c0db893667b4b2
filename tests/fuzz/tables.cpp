// SPDX-License-Identifier: MIT
// Tables of poses, encoder counts, lines and truths; what reads as a line is judged, too, in bounded time.
#include <array>

#include "common/core/numbers.hpp"
#include "common/geometry/pose_track.hpp"
#include "common/session/session.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/robot/path/checks/line_check.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file{data, size};
  for (const auto order : {session::RowOrder::Rising, session::RowOrder::Any}) {
    const auto poses = session::read_pose_table(file.path(), order);
    if (!poses) {
      fuzz::demand_clean(poses.error());
      continue;
    }
    for (const session::StampedPose& pose : *poses)
      fuzz::demand(is_plausible_place(Vec3{pose.T_base_flange.translation()}), "poses are near");
  }
  constexpr std::array<std::int64_t, 4> k_stamps_ns{0, 1000, 2000, 3000};
  const auto counts = session::read_encoder_table(file.path(), k_stamps_ns);
  if (!counts) fuzz::demand_clean(counts.error());
  for (std::size_t i = 0; counts && i < counts->size(); ++i) {
    const std::int64_t ticks = (*counts)[i].value_or(0);
    fuzz::demand(ticks >= -geometry::k_most_ticks && ticks <= geometry::k_most_ticks, "counts are counts");
  }
  for (const auto& line : {cloud::read_line(file.path()), cloud::read_positions(file.path())}) {
    if (!line) {
      fuzz::demand_clean(line.error());
      continue;
    }
    for (const cloud::LinePoint& p : line->points)
      fuzz::demand(is_plausible_place(p.position), "points are near");
    fuzz::demand(!path::check_line(*line).empty(), "a line is judged");
  }
  return 0;
}
