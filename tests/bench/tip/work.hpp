// SPDX-License-Identifier: MIT
#pragma once
/// \file A line worked: planned, sent as a script, followed by the arm; and how far off the true tip was.

#include <filesystem>
#include <optional>

#include "host/robot/path/tip_bound.hpp"
#include "tests/bench/tip/scan.hpp"

namespace biteline::bench {

/// What came of one process on one shoe.
struct Worked {
  std::vector<double> off_mm{};  ///< every half millimetre of the path's worked part
  path::TipParts parts{};        ///< of the bound, as stated before it was sent
  double planned_s{0};           ///< along the line
  bool waits{false};             ///< beyond the process's tolerance: a person's word is needed
  std::string refused{};         ///< why there is no path; empty: there is one
};

/// The distance is that of the place which the tool works at, carried by the true tip's frame, from the true
/// line: the process's own offset is taken off, as followed.json does it with the planned tip.
[[nodiscard]] Result<Worked> work(const TipScan& scan, const HostScan& host, const path::Process& process,
                                  const Variant& variant);

}  // namespace biteline::bench
