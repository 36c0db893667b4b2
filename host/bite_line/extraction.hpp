// SPDX-License-Identifier: MIT
#pragma once
/// \file What comes out when a bite line is looked for.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/path/seen_gates.hpp"
#include "host/bite_line/refused.hpp"
#include "host/bite_line/side/seam_step.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/uncertainty/arm_sway.hpp"
#include "host/cloud/uncertainty/scan_spread.hpp"
#include "host/report/stage_clock.hpp"

namespace biteline::bite_line {

struct Config {
  double point_spacing_mm{0.5};      ///< of the resulting line
  double min_confidence_ratio{0.5};  ///< a line less sure than this is a person's to look at
  /// The head that scanned, with what its calibration states: part of U95 where the scan has poses, too.
  std::shared_ptr<const uncertainty::KnownHead> head{};
  /// Of the arm, by earlier scans: for one with poses that does not show it.
  std::optional<uncertainty::ArmGive> arm_give{};
};

/// A closed crease that could be the bite line.  The first of a list is the best one.
struct Candidate {
  double confidence{0};      ///< 0 to 1, in comparison with its rivals
  double mean_height_mm{0};  ///< above the sole's bottom, as far as the cloud shows it
  double length_mm{0};
  double closure_mm{0};      ///< height between the path's two ends at the seam of the unrolled side
  double crease_deg{0};      ///< median turn of the surface across it, positive when concave
  double seen_share{0};      ///< share of its length where the surface was seen
  std::vector<Vec3> points;  ///< base, mm, in order
  /// What each point lacks, as bits of Lack; empty: nobody looked (all but the first).
  std::vector<std::uint8_t> lacks{};
};

enum class Verdict {
  Refused,  ///< there is no line to show
  Review,   ///< a line, and a person must settle its flagged stretches before anything is done along it
  Ok,
};

struct Extraction {
  bool found{false};                 ///< a line that may be worked
  std::optional<Refusal> refusal{};  ///< when not found: why there is no line, or why a person must look
  /// When not found, and the scan itself shows too little: it goes before `refusal`.
  std::optional<report::ToldRefusal> scan_cause{};
  cloud::ClosedLine line{};        ///< empty when refused; when not found, its open stretches are flagged
  double confidence{0};            ///< that the line as a whole is the bite line
  double closure_mm{0};            ///< of the published method; other lines close
  std::optional<SeamStep> seam{};  ///< how far the scan's end lies from its begin, where it shows both
  double length_mm{0};
  double bridged_mm{0};     ///< length without a visible crease, bridged from both sides
  bool head_in_u95{false};  ///< U95 holds calibration, poses and clock beside noise, gaps and layers
  std::optional<uncertainty::ArmMotion> arm{};  ///< in U95, where the scan has poses
  std::vector<Candidate> candidates{};          ///< found or not, best first
  std::vector<SeenGate> gates{};                ///< of the first candidate; empty: it did not come so far
  SE3 T_base_shoe{SE3::Identity()};
  std::vector<report::StageTime> stages{};  ///< in order, wall time

  [[nodiscard]] Verdict verdict() const {
    if (found) return Verdict::Ok;
    return line.points.empty() ? Verdict::Refused : Verdict::Review;
  }
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

}  // namespace biteline::bite_line
