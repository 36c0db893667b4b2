// SPDX-License-Identifier: MIT
#pragma once
/// \file What a second look writes beside report.json: the band as a table and as a picture.

#include <nlohmann/json.hpp>
#include <string>

#include "host/second_look/second_look.hpp"

namespace biteline::look {

/// `work` of report.json.
[[nodiscard]] nlohmann::ordered_json as_json(const second_look::Findings& findings,
                                             const second_look::PlannedBand& plan);
/// band.csv: a row for each place.
[[nodiscard]] std::string band_table(const second_look::Findings& findings);
/// band.svg: the line unrolled, what was worked on it, and the faults.
[[nodiscard]] std::string band_picture(const second_look::Findings& findings,
                                       const second_look::PlannedBand& plan);

}  // namespace biteline::look
