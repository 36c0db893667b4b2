// SPDX-License-Identifier: MIT
#pragma once
/// \file One shoe through the simulated cell: cell, sensor and host as processes, from the scan to the arm
/// that follows.

#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/apps/biteline-demo/made_times.hpp"
#include "host/bite_line/evaluation/line_error.hpp"

namespace biteline::demo {

/// The same for all shoes of a demo.
struct CellOptions {
  std::filesystem::path out{"demo-result"};
  std::uint64_t seed{5};
  std::string shoe{"deep"};
  std::string arm{"ur10e"};
  std::string world{"real"};           ///< or ideal: without what an arm, a lamp and a laser add
  double size{42};                     ///< European; 0: as long as the class draws it
  double speed_mm_s{400};              ///< of the stripe along the outline, where the arm's joints allow it
  double rate_hz{200};                 ///< pictures a second: 2 mm apart at that speed
  double scan_begin_ratio{0.25};       ///< of the way round, from the heel, anticlockwise: in the waist
  bool scan_clockwise{true};           ///< the path, anticlockwise, then turns the wrist back
  std::optional<double> time_ratio{};  ///< of real time, of scans; nothing: what the machine can
  std::filesystem::path process;
  bool quiet{false};
};

/// What stands in the cell.
struct Shoe {
  std::string name;        ///< also the folder of its results
  std::uint64_t place{0};  ///< where it stands, by seed; 0: as the shoe's seed
  std::optional<std::filesystem::path>
      sample{};  ///< an upper without a sole: the folder of its finished sample
};

struct ShoeResult {
  Shoe shoe;
  std::filesystem::path scan;  ///< the host's result folder
  int host_status{0};
  std::string verdict;
  std::optional<evaluation::LineError> error;  ///< against the cell's own truth; none without a line
  double time_ratio{1};                        ///< of real time, of the scan
  double scan_s{0};  ///< once round, in the arm's time; without the ways there and back
  double wall_s{0};
  std::optional<MadeTimes> made{};  ///< where the arm followed

  [[nodiscard]] bool good() const { return host_status == 0; }
};

/// Starts the three programs, waits until the host has done its work, and stops them, whatever happens. Fails
/// when one cannot be started or leaves no result; a refusal is a result.
[[nodiscard]] Result<ShoeResult> run_shoe(const CellOptions& options, const Shoe& shoe);

}  // namespace biteline::demo
