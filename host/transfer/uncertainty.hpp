// SPDX-License-Identifier: MIT
#pragma once
/// \file How far a carried line may be off: per point, and as one bound.

#include <span>
#include <vector>

#include "host/cloud/uncertainty/whole_scan.hpp"
#include "host/transfer/align/alignment.hpp"
#include "host/transfer/align/evidence.hpp"
#include "host/transfer/carry/carried_line.hpp"

namespace biteline::transfer {

/// Sets each point's standard deviation: that which, of a normal distribution, would hold as much of the
/// belief as it does with 95 %.  Only what moves the carried line counts: the ray puts it back on to the
/// wall, and along itself a line cannot be off.
void tell_spread(const Belief& belief, const SE3& T_target_source, const CarryOptions& options,
                 std::vector<PlacedPoint>& placed);

/// The same of another size: what wall, rims and law leave open of placement and grade.  `on_sample`: the
/// points as `Alignment::placed()` takes them.
void tell_graded_spread(const Alignment& alignment, std::span<const Alignment::OnLine> on_sample,
                        const CarryOptions& options, std::vector<PlacedPoint>& placed);

/// The upper's surface is where its scan has it: widens each point's U95 by what the scan does not know, and
/// lowers its confidence.
void add_scan(const uncertainty::WholeScan& scan, const Vec3& up, cloud::ClosedLine& line);

/// Within which 19 of 20 points of such standard deviations are.
[[nodiscard]] double bound_mm(const std::vector<double>& sigmas_mm);

}  // namespace biteline::transfer
