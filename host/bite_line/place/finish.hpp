// SPDX-License-Identifier: MIT
#pragma once
/// \file From the decision and the placed line to what is handed out, in base.

#include <optional>
#include <vector>

#include "host/bite_line/extraction.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/side/side.hpp"
#include "host/cloud/uncertainty/whole_scan.hpp"

namespace biteline::bite_line {

/// `placed` is empty when the decision is a refusal that is not for review.  What was bridged was not seen to
/// be the bite line: it lowers the confidence, and a line that is then below the limit is for review, as is
/// one of which too much is flagged.  Of a line for review more than that is flagged in any case.
[[nodiscard]] Extraction finish(const Side& side, const Decision& decision, const PlacedLine& placed,
                                const Config& config, const uncertainty::WholeScan& whole = {});

/// A cloud that ended before there was a side.
[[nodiscard]] Extraction refused(Refusal refusal, std::vector<report::StageTime> stages);

/// Evenly spaced along the placed line, in base, with tangents.  `of_line`: that the line is the bite line.
[[nodiscard]] cloud::ClosedLine even_line(const PlacedLine& placed, const SE3& T_base_shoe, double of_line,
                                          const uncertainty::WholeScan& scan, double spacing_mm);

/// Central differences of the closed line's positions, over a millimetre and a half to either side.
void add_tangents(cloud::ClosedLine& line);
/// Normals lean along the line, over 3 mm to either side, by 15 degrees at most: at the edge of a strip the
/// surface turns, and a tool would turn with it.
void turn_normals_across(cloud::ClosedLine& line);

}  // namespace biteline::bite_line
