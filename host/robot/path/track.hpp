// SPDX-License-Identifier: MIT
#pragma once
/// \file How well an arm followed: its recorded track against the path and against the line.

#include <optional>
#include <span>

#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::path {

struct TrackSample {
  double time_s{0};
  SE3 T_base_tcp;
  std::optional<Vec3> force_base_newton{};  ///< on the tool at its tip, by the arm's own sensor
  std::optional<double> flange_ratio{};     ///< of its full force, as a flange reads it
  bool presses{false};                      ///< the program says that the tool touches
};

/// How long each part of a whole run took, from the track's first sample on.
struct PartTimes {
  double way_there_s{0};  ///< to the path's beginning
  double approach_s{0};
  double line_s{0};  ///< from the first to the last place on the line, ways between stretches included
  double retreat_s{0};
};

struct TrackDeviation {
  std::size_t samples{0};  ///< on the line, approach and retreat left out
  double mean_mm{0};       ///< of the tip from the planned way
  double rms_mm{0};
  double p95_mm{0};  ///< 95 of 100 samples are no farther from it
  double max_mm{0};
  double max_at_mm{0};  ///< along the path
  double max_rad{0};    ///< of the tool's direction and turn
  double line_mean_mm{
      0};  ///< of the place the tool works at from the bite line (the process's offset taken off)
  double line_p95_mm{0};
  double line_max_mm{0};
  double covered{0};      ///< share of the line's waypoints that were passed within 0.5 mm
  bool completed{false};  ///< reached the path's end
  PartTimes parts{};      ///< of what is not completed, as far as it went
};

/// Goes along path and track together, so that the overlap of the seam is not confused with the beginning.
[[nodiscard]] TrackDeviation deviation(const PlannedPath& path, std::span<const TrackSample> track);

}  // namespace biteline::path
