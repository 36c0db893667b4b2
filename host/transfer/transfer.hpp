// SPDX-License-Identifier: MIT
#pragma once
/// \file A sample's line on the next upper: align, then carry over by rays.

#include <optional>

#include "host/bite_line/side/seam_step.hpp"
#include "host/cloud/uncertainty/whole_scan.hpp"
#include "host/report/stage_clock.hpp"
#include "host/transfer/align/alignment.hpp"
#include "host/transfer/carry/carried_line.hpp"
#include "host/transfer/ready_sample.hpp"
#include "host/transfer/refused.hpp"
#include "host/transfer/sample_folder.hpp"

namespace biteline::transfer {

struct TransferOptions {
  transfer::AlignOptions align{};
  transfer::RayDirection direction{transfer::RayDirection::Level};
  double max_gap_mm{45};  ///< longest gap in the upper's scan that is bridged (docs/transfer.md)
  uncertainty::WholeScan upper_scan{};  ///< what is known of the scan that the upper's cloud is of
};

struct Transfer {
  bool found{false};
  std::optional<Refusal> refusal{};  ///< when not found
  /// When not found, and the upper's scan itself shows too little: it goes before `refusal`.
  std::optional<report::ToldRefusal> scan_cause{};
  std::optional<bite_line::SeamStep>
      seam{};  ///< how far out the upper's scan ends from where it began, where it shows both
  transfer::Alignment alignment{};
  std::vector<transfer::PlacedPoint>
      placed{};  ///< the sample's line where the alignment has put it; empty when refused before
  transfer::CarriedLine carried{};  ///< its line is empty when not found
  double bound_mm{
      0};  ///< 19 of 20 points of the line are nearer than this to the bite line, as far as the scans tell
  double confidence{0};                         ///< mean over the points
  bool sample_u95{false};                       ///< the sample's own is in that of the points
  bool head_u95{false};                         ///< so are calibration, poses and clock
  std::optional<uncertainty::ArmMotion> arm{};  ///< so is what the upper's scan tells of its arm
  bool from_mesh{false};                        ///< the upper's scan was organised
  std::vector<report::StageTime> stages{};      ///< in order, wall time; empty when a cloud holds no shoe

  /// Why not found.
  [[nodiscard]] std::optional<report::ToldRefusal> told() const {
    if (scan_cause || !refusal) return scan_cause;
    return report::told(*refusal);
  }
  /// One plain sentence when not found.
  [[nodiscard]] std::string reason() const {
    return scan_cause ? scan_cause->reason : refusal ? refusal->reason : std::string{};
  }
};

/// Never fails: without a line the Transfer has its refusal.
[[nodiscard]] Transfer transfer_line(const ReadySample& sample, const cloud::PointCloud& upper,
                                     const TransferOptions& options);
/// The same for one upper.
[[nodiscard]] Transfer transfer_line(const SampleFiles& sample, const cloud::PointCloud& upper,
                                     const TransferOptions& options);

}  // namespace biteline::transfer
