// SPDX-License-Identifier: MIT
#pragma once
/// \file What came out for one recording: the same bytes whenever and wherever it is computed.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::batch {

/// ok, review, refused; unreadable (exit status 2), failed (4), crashed, timed_out, out_of_memory; changed:
/// since it was planned.
[[nodiscard]] std::span<const char* const> verdict_names();
/// ok or review.
[[nodiscard]] bool has_line(const std::string& verdict);
/// A sound answer about the recording: ok, review, refused or unreadable.  All others are the program's
/// fault.
[[nodiscard]] bool is_answer(const std::string& verdict);

struct LinePlace {
  float x_mm{0}, y_mm{0}, z_mm{0};
  float u95_mm{-1};  ///< below 0: unknown
};

struct Outcome {
  std::string verdict;
  std::string reason_code;
  std::string reason;
  std::optional<double> length_mm, confidence, u95_mm, u95_max_mm, bridged_mm;
  // Against the truth, where one is beside the recording.
  std::optional<double> error_mean_mm, error_p95_mm, error_max_mm, complete;
  std::optional<double> u95_inside;  ///< share of the line's points whose U95 holds the truth
  std::optional<double> wrong_mm;    ///< length off by more than 1 mm outside flagged points
  std::string line_hash;             ///< SHA-256 of line.csv; empty without one
};

/// What it took; never part of what is compared by bytes.
struct Cost {
  double wall_s{0};
  double cpu_s{0};
  double peak_memory_mb{0};
};

/// Name, member and unit of every figure, for files, tables and pages.
struct FigureRow {
  const char* name;
  std::optional<double> Outcome::*member;
};
[[nodiscard]] std::span<const FigureRow> figure_table();

/// A line with more than 5 mm wrong is a wrong one.
inline constexpr double k_most_wrong_mm = 5;
[[nodiscard]] inline bool is_wrong(const Outcome& outcome) {
  return outcome.wrong_mm && *outcome.wrong_mm > k_most_wrong_mm;
}

[[nodiscard]] nlohmann::ordered_json to_json(const Outcome& outcome);
[[nodiscard]] Result<Outcome> outcome_of(const nlohmann::ordered_json& json,
                                         const std::filesystem::path& file);

/// Errors of a line against the truth, into the outcome.
void judge_by_truth(Outcome& outcome, const cloud::ClosedLine& line, const cloud::ClosedLine& truth);

[[nodiscard]] std::vector<LinePlace> places_of(const cloud::ClosedLine& line);

/// From a point to the closed polyline; mm.  Infinite for an empty line.
[[nodiscard]] double distance_mm(const LinePlace& point, std::span<const LinePlace> line);

}  // namespace biteline::batch
