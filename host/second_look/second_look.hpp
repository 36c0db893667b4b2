// SPDX-License-Identifier: MIT
#pragma once
/// \file What a process did along a line, by a scan before it and a scan after it.
///
/// Both clouds are in base and organised or not; the shoe stands as it stood.  Ways along are on the line
/// from its first point, ways across on the surface and square to the line, upwards > 0; mm.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/second_look/refused.hpp"
#include "host/transfer/moved.hpp"

namespace biteline::second_look {

/// A stretch along the line; over its first point where `to_mm` is less.
struct Arc {
  double from_mm{0}, to_mm{0};
};

/// What was to be done.
struct PlannedBand {
  double low_mm{0}, high_mm{8};
  /// Where the tool goes, the middle of what it leaves: places beside the line, base, in any order.  The band
  /// lies about the surface beside them, and all ways across are counted so that this is (low + high) / 2.
  /// Empty: ways are the surface's from the line, which a step or a groove makes longer.
  std::vector<Vec3> middle_base{};
  std::vector<Arc> left_out{};
  std::vector<Arc> twice{};  ///< worked more than once by the plan: nothing is doubled there
  /// An edge farther off the plan, its U95 taken off, is a fault.  An arm's path and a tool's edge are within
  /// half of it.
  double tolerance_mm{0.5};
};

enum class FaultKind : std::uint8_t {
  Missing,  ///< not worked, all across or in the middle of the band
  Narrow,   ///< an edge lies inside the plan
  Wide,     ///< an edge lies outside
  Beside,   ///< the band, or something apart from it, lies beside its place
  Doubled,  ///< worked twice: changed by half as much again
};
[[nodiscard]] const char* name_of(FaultKind kind);

struct Fault {
  FaultKind kind{FaultKind::Missing};
  Arc along{};
  Arc within{};                  ///< from the last profile before it that lacks it to the first one behind
  double low_mm{0}, high_mm{0};  ///< what of the surface across it takes
  Vec3 middle_base{Vec3::Zero()};
};

enum class Unclear : std::uint8_t {
  NotSeen,     ///< too few points in one of the scans
  NoContrast,  ///< worked and unworked surface are too alike
};
[[nodiscard]] const char* words_of(Unclear why);

struct CannotTell {
  Arc along{};
  Unclear why{Unclear::NotSeen};
};

/// One edge at one place.
struct BandEdge {
  double across_mm{0};
  double u95_mm{0};
  Vec3 base{Vec3::Zero()};  ///< on the first scan's surface
};

/// The band at one place of the line.
struct BandPlace {
  double along_mm{0};
  bool planned{true};
  std::optional<Unclear> unclear{};
  bool worked{false};
  std::optional<BandEdge> low{}, high{};  ///< none: not worked, or its end is hidden
};

struct Findings {
  std::optional<Refusal> refusal{};
  std::vector<BandPlace> places{};  ///< one for each profile of the second scan, by their places on the line
  std::vector<Fault> faults{};
  std::vector<CannotTell> cannot_tell{};
  double line_mm{0};
  double planned_mm{0};
  double worked_mm{0};       ///< of what was planned
  double unclear_mm{0};      ///< likewise
  double contrast_ratio{0};  ///< change over its noise at a place of the band, median along the line
  double light_ratio{1};     ///< stripe's amplitude on unworked surface, second scan over first
  transfer::Moved moved{};   ///< whether the shoe stands as it stood, the band left out
};

/// Pre: the line has 3 points at least.  Where `first` or `second` has no amplitude or width, the surface's
/// height alone tells.
[[nodiscard]] Findings look_again(const cloud::PointCloud& first, const cloud::PointCloud& second,
                                  const cloud::ClosedLine& line, const PlannedBand& plan);

}  // namespace biteline::second_look
