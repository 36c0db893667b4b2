// SPDX-License-Identifier: MIT
#pragma once
/// \file A line's U95 in short: pooled, at its largest, and what it holds.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/cloud/closed_line.hpp"
#include "host/cloud/uncertainty/arm_sway.hpp"
#include "host/report/page.hpp"

namespace biteline::results {

/// Words for report.json: what a U95 holds, and what it does not.
struct U95Parts {
  std::vector<std::string> holds;
  std::vector<std::string> lacks;
  std::optional<uncertainty::ArmMotion> arm{};
};

/// What of a scan as a whole is in a U95.
struct U95OfScan {
  bool head{false};  ///< calibration, poses and clock
  std::optional<uncertainty::ArmMotion> arm{};
};
/// Of a line found in a scan.
[[nodiscard]] U95Parts parts_of_found_line(const U95OfScan& scan);
/// Of a line carried over from a sample into this scan; `sample`: the sample's own U95 is known.
[[nodiscard]] U95Parts parts_of_carried_line(const U95OfScan& scan, bool sample);

/// The radius that holds 95 % of all points, each taken as round about its place.  Pre: every point has a
/// U95.
[[nodiscard]] double pooled_u95_mm(const cloud::ClosedLine& line);

/// `pooled_mm`, `max_mm`, `max_at_mm` (along the line), `holds`, `lacks`, and of the arm where there is a
/// figure `arm_sigma_mm`, `arm_from`, `arm_give_mm_per_m_s2`, and where the scan shows it `arm_profiles`.
/// Null where a point has none.
[[nodiscard]] nlohmann::ordered_json u95_json(const cloud::ClosedLine& line, const U95Parts& parts);

/// The `u95` of report.json's fields as a table with what it means; nothing where there is none.
void add_u95(report::Page& page, const nlohmann::ordered_json& fields);

}  // namespace biteline::results
