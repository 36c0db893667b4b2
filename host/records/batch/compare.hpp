// SPDX-License-Identifier: MIT
#pragma once
/// \file Two runs of the same recordings: what changed, and whether it is worse.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/records/batch/result_set.hpp"
#include "host/report/refusal.hpp"

namespace biteline::batch {

/// A point without U95 has moved when it did so by more than this.
inline constexpr double k_allowed_without_u95_mm = 0.1;
/// Less is no move: baselines are rounded to a micron.
inline constexpr double k_no_move_mm = 0.002;

enum class Judgement : std::uint8_t { Better, Same, Worse };

/// A recording whose answer changed.
struct Difference {
  std::string name;
  Judgement judgement{Judgement::Same};
  std::string what;  ///< one line for a person
  std::optional<std::size_t> old_row, new_row;
  double moved_mm{0};       ///< the largest way of a point; of lines only
  std::vector<bool> moved;  ///< of the new line's points, where it moved
};

struct Comparison {
  std::vector<Difference> differences;  ///< by name; recordings that are equal have none
  std::size_t compared{0};
  std::size_t added{0};                                ///< only in the new run: told, not judged
  std::optional<double> old_cpu_s, new_cpu_s;          ///< of what both measured
  std::optional<double> old_memory_mb, new_memory_mb;  ///< the largest

  [[nodiscard]] std::size_t count(Judgement judgement) const;
};

/// Worse: an answer lost, a line lost, a line moved beyond its stated U95 or found where there was none,
/// unless the truth says that it is better now; and a recording that is gone or another one.
[[nodiscard]] Result<Comparison> compare_runs(const ResultSet& before, const ResultSet& after);

/// index.html with both lines of what moved most beside each other.
[[nodiscard]] Result<void> write_comparison_page(const Comparison& comparison, const ResultSet& before,
                                                 const ResultSet& after, const std::filesystem::path& out,
                                                 int pictures);

enum class CompareRefused { Worse };
[[nodiscard]] std::span<const report::RefusalRow<CompareRefused>> refusal_table(CompareRefused);
/// Names what is worse; none when nothing is.
[[nodiscard]] std::optional<report::Refusal<CompareRefused>> refusal_of(const Comparison& comparison);

}  // namespace biteline::batch
