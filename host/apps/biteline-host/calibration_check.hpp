// SPDX-License-Identifier: MIT
#pragma once
/// \file Each scan checks the calibration that it was made with; the cell's memory keeps what came before.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/calibration/drift/evidence.hpp"
#include "host/intake/scan_intake.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::service {

/// What the service does about a calibration that has drifted.
enum class OnDrift : std::uint8_t { Warn, Stop };

/// What a scan shows of its own calibration.  Takes a core for some tenths of a second, and no second one.
[[nodiscard]] Result<drift::Evidence> look_at_calibration(const intake::ScanOutcome& scan);

/// Judges that, adds `calibration_check` to the folder's report.json, keeps the judgement in the memory and
/// tells a drift in one line.  True: the calibration has drifted.  A scan is judged once, however often this
/// is called; another head, or another calibration of it, begins anew.  Without report.json: nothing is done.
/// `model`: whose shoe it is; empty: not known.
[[nodiscard]] Result<bool> check_calibration(const std::filesystem::path& folder,
                                             const Result<drift::Evidence>& evidence,
                                             const geometry::SensorModel& sensor, memory::Memory& memory,
                                             OnDrift on_drift, const std::string& model = {});

/// Forgets what was learnt, also a drift: the next scans are the usual ones.  `who` stands in the log.
[[nodiscard]] Result<void> begin_calibration_check_anew(memory::Memory& memory, const std::string& who);

}  // namespace biteline::service
