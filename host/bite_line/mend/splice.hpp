// SPDX-License-Identifier: MIT
#pragma once
/// \file New points put between two points of a line.

#include <cstddef>
#include <span>
#include <vector>

#include "host/cloud/closed_line.hpp"

namespace biteline::mend {

/// A mended point lies no better than this, unless a crease was measured at it.
inline constexpr double k_least_u95_mm = 0.5;

/// The two points of a line between which it is mended; both stay.
struct Ends {
  std::size_t first{0};
  std::size_t last{0};
};

[[nodiscard]] std::size_t nearest_index(const cloud::ClosedLine& line, const Vec3& place);

/// Points from `ends.first` on to `ends.last`, both among them.
[[nodiscard]] std::vector<cloud::LinePoint> between(const cloud::ClosedLine& line, Ends ends);

/// The stretch of `placed` beside that of `line`, led into its two ends, and moved onto those of `hints` that
/// no crease near them holds.  A point of source `Seen` lies on a crease that was measured.
[[nodiscard]] std::vector<cloud::LinePoint> led_stretch(const cloud::ClosedLine& placed,
                                                        const cloud::ClosedLine& line, Ends ends,
                                                        std::span<const Vec3> hints);

/// An arc that leaves both ends in their own directions; sure and good as the bridge of a gap is.
[[nodiscard]] std::vector<cloud::LinePoint> bridged_stretch(const cloud::ClosedLine& line, Ends ends);

/// `point` as a mended one in the place of `replaced`.
void mark_mended(cloud::LinePoint& point, const cloud::LinePoint& replaced);

/// `line` with `stretch` (from end to end, both among them) between its ends, evenly spaced there; every
/// point within is marked.
[[nodiscard]] cloud::ClosedLine splice(const cloud::ClosedLine& line, Ends ends,
                                       std::span<const cloud::LinePoint> stretch);

}  // namespace biteline::mend
