// SPDX-License-Identifier: MIT
#pragma once
/// \file What a scan that has come in tells of its own uncertainty, where no line is looked for in it.

#include <optional>

#include "host/cloud/uncertainty/whole_scan.hpp"
#include "host/intake/scan_intake.hpp"

namespace biteline::intake {

/// `head`: how well the one that scanned is known.  `earlier`: of its arm, by earlier scans.  Nothing of the
/// arm for a scan without poses.
[[nodiscard]] uncertainty::WholeScan whole_scan_of(const ScanOutcome& scan,
                                                   const std::optional<uncertainty::HeadUncertainty>& head,
                                                   const std::optional<uncertainty::ArmGive>& earlier);

}  // namespace biteline::intake
