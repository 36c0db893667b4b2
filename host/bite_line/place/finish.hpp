// SPDX-License-Identifier: MIT
#pragma once
/// \file From the decision and the placed line to what is handed out, in base.

#include <optional>
#include <vector>

#include "host/bite_line/extraction.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// What a scan as a whole adds to its points' uncertainty, as far as it is known.
struct WholeScan {
  std::optional<uncertainty::ScanSpread> head{};  ///< calibration, poses and clock
  std::optional<uncertainty::ArmMotion> arm{};    ///< what the scan tells of its arm
};

/// `placed` is empty when the decision is a refusal.  What was bridged was not seen to be the bite line: it
/// lowers the confidence, and a line that is then below the limit is refused.
[[nodiscard]] Extraction finish(const Side& side, const Decision& decision, const PlacedLine& placed,
                                const Config& config, const WholeScan& whole = {});

/// A cloud that ended before there was a side.
[[nodiscard]] Extraction refused(Refusal refusal, std::vector<report::StageTime> stages);

/// Evenly spaced along the placed line, in base, with tangents.  `of_line`: that the line is the bite line.
[[nodiscard]] cloud::ClosedLine even_line(const PlacedLine& placed, const SE3& T_base_shoe, double of_line,
                                          const WholeScan& scan, double spacing_mm);

/// A point of less confidence, or of more U95 than the second, is flagged.
inline constexpr double k_sure_ratio = 0.5;
inline constexpr double k_sure_mm = 1.0;

/// A line with more than this flagged is none: a tool would work beside the bite line there.
inline constexpr double k_most_flagged_share = 0.1;

/// Shares of the line's points that are flagged, by what flags them.
struct Flagged {
  double unsure{0};     ///< too little confidence
  double uncertain{0};  ///< sure enough, and yet too much U95

  [[nodiscard]] double all() const { return unsure + uncertain; }
};

/// A point below `min_confidence` counts as flagged, too.
[[nodiscard]] Flagged flagged_of(const cloud::ClosedLine& line, double min_confidence);

/// Central differences of the closed line's positions, over a millimetre and a half to either side.
void add_tangents(cloud::ClosedLine& line);

}  // namespace biteline::bite_line
