// SPDX-License-Identifier: MIT
#pragma once
/// \file The arm's way through a cell's life, as its controller knows it.

#include <filesystem>
#include <mutex>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"

namespace biteline::sim {

struct TrackRow {
  Nanoseconds stamp;  ///< robot clock
  SE3 T_base_tcp;
  bool program;
  std::uint32_t outputs;
  bool scans;         ///< ScanActive is high
  double time_ratio;  ///< of real time, at which it goes (slow_motion.hpp)
};

/// Rows are added while the arm moves, up to an hour at 500 Hz.  Thread: any.
class CellTrack {
 public:
  void add(const TrackRow& row);
  /// One line per row: #timestamp [ns], T_base_tcp as position and quaternion, whether a script ran, digital
  /// outputs, ScanActive, the share of real time.
  [[nodiscard]] Result<void> write(const std::filesystem::path& file) const;

 private:
  mutable std::mutex mutex_;
  std::vector<TrackRow> rows_;
};

}  // namespace biteline::sim
