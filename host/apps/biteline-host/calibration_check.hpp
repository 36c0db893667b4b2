// SPDX-License-Identifier: MIT
#pragma once
/// \file Each scan checks the calibration that it was made with; the cell's memory keeps what came before.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/intake/scan_intake.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::service {

/// What the service does about a calibration that has drifted.
enum class OnDrift : std::uint8_t { Warn, Stop };

/// Judges the scan in `folder`, whose messages are still there, adds `calibration_check` to its report.json,
/// keeps the judgement in the memory and tells a drift in one line.  True: the calibration has drifted.  A
/// scan is judged once, however often this is called; another head, or another calibration of it, begins
/// anew.  Without report.json: nothing is done.
[[nodiscard]] Result<bool> check_calibration(const std::filesystem::path& folder,
                                             const intake::ScanOutcome& scan, memory::Memory& memory,
                                             OnDrift on_drift);

/// Forgets what was learnt, also a drift: the next scans are the usual ones.  `who` stands in the log.
[[nodiscard]] Result<void> begin_calibration_check_anew(memory::Memory& memory, const std::string& who);

}  // namespace biteline::service
