// SPDX-License-Identifier: MIT
#pragma once
/// \file New points put between two points of a line.

#include <cstddef>
#include <span>
#include <vector>

#include "host/cloud/closed_line.hpp"

namespace biteline::edit {

/// What a hand is good for on a shoe's surface.  A mended point lies no better, unless a crease was measured
/// at it.
inline constexpr double k_hand_u95_mm = 0.5;
/// That a hand is within 0.3 mm: it errs along the surface, across the line, with that U95.
inline constexpr double k_hand_confidence = 0.76;

/// The two points of a line between which it is mended; both stay.
struct Ends {
  std::size_t first{0};
  std::size_t last{0};
};

[[nodiscard]] std::size_t nearest_index(const cloud::ClosedLine& line, const Vec3& place);

/// Points from `ends.first` on to `ends.last`, both among them.
[[nodiscard]] std::vector<cloud::LinePoint> between(const cloud::ClosedLine& line, Ends ends);

/// What became of a point that a hand has set.
struct Snap {
  Vec3 wanted{Vec3::Zero()};
  bool on_crease{false};  ///< the line keeps to the crease beside it; else it leads through the point
  double by_mm{0};        ///< from the point to the crease; 0 where there is none
};

/// What a hand says of a stretch.
struct Word {
  std::span<const Vec3> hints{};  ///< it leads through these
  bool chosen{false};             ///< it has seen all of the stretch, and takes it
};

/// The stretch of `placed` beside that of `line`, led into its two ends, and moved onto those hints that no
/// crease near them holds.  A point of source `Seen` lies on a crease that was measured; what the hand
/// vouches for, all of a chosen stretch and 20 mm to both sides of a hint, is marked as by hand.  `snaps`
/// (optional): one for each hint.
[[nodiscard]] std::vector<cloud::LinePoint> led_stretch(const cloud::ClosedLine& placed,
                                                        const cloud::ClosedLine& line, Ends ends,
                                                        const Word& word, std::vector<Snap>* snaps = nullptr);

/// An arc that leaves both ends in their own directions; sure and good as the bridge of a gap is.
[[nodiscard]] std::vector<cloud::LinePoint> bridged_stretch(const cloud::ClosedLine& line, Ends ends);

/// A hand vouches for the point: its U95 is the hand's, or what the crease there gives where that is less.
void mark_by_hand(cloud::LinePoint& point);
/// The point is mended, and no hand vouches for its place: as good as its crease or its bridge.  One that is
/// by hand already stays so.
void mark_mended(cloud::LinePoint& point);
/// The same of a point that no person has looked at: no surer than the one that it replaces.
void mark_mended(cloud::LinePoint& point, const cloud::LinePoint& replaced);

/// `line` with `stretch` (from end to end, both among them) between its ends, evenly spaced there; every
/// point within is marked.
[[nodiscard]] cloud::ClosedLine splice(const cloud::ClosedLine& line, Ends ends,
                                       std::span<const cloud::LinePoint> stretch);

}  // namespace biteline::edit
