// SPDX-License-Identifier: MIT
#pragma once
/// \file Which rows of the line are told worked and which missing, by what they tell together.

#include <cstdint>
#include <span>
#include <vector>

namespace biteline::second_look {

/// A gap as long as this must be found.
inline constexpr double k_gap_mm = 2;
/// Nothing shorter is told of: it may be one profile of a fast scan, which lies off.
inline constexpr double k_least_told_mm = 1.6;

enum class Told : std::uint8_t { Unclear, Worked, Missing };

/// What one row tells of the plan.
struct RowScore {
  enum class Counts : std::uint8_t {
    Yes,
    Passed,  ///< it tells nothing, and hides nothing that must be found
    No,      ///< not planned, or not seen: nothing is told across it
  };
  double along_mm{0};
  double likelihood{0};  ///< logarithm, of worked over not worked
  double evidence{0};    ///< what that logarithm would be if it were as expected
  Counts counts{Counts::Yes};
};

/// Rows are sorted along a closed line.  Told worked is what no stretch of `k_least_told_mm` contradicts,
/// told missing what such a stretch at least tells together; all else is unclear.
[[nodiscard]] std::vector<Told> told_along(std::span<const RowScore> rows, double line_mm);

}  // namespace biteline::second_look
