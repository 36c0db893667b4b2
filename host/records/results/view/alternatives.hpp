// SPDX-License-Identifier: MIT
#pragma once
/// \file What a person chooses from on a flagged stretch of a line: where the other candidates run there.

#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "host/bite_line/extraction.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/records/results/view/weak_stretches.hpp"

namespace biteline::results {

/// Another way from a stretch's begin to its end.
struct Alternative {
  int candidate{0};          ///< counted from 1, as in report.json
  double off_mm{0};          ///< how far it leads away from the line at most
  std::vector<Vec3> points;  ///< base, mm, in the order of the line; at most 200
};

/// Of the candidates that part from the line by more than a millimetre there.
[[nodiscard]] std::vector<Alternative> alternatives(const cloud::ClosedLine& line, const WeakStretch& stretch,
                                                    std::span<const bite_line::Candidate> candidates);

/// `weak_stretches` of report.json for a line that a person must settle: each with `reason_code` and
/// `alternatives`.
[[nodiscard]] nlohmann::ordered_json as_open(const std::vector<WeakStretch>& stretches,
                                             const cloud::ClosedLine& line,
                                             std::span<const bite_line::Candidate> candidates);

}  // namespace biteline::results
