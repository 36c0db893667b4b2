// SPDX-License-Identifier: MIT
#pragma once
/// \file Repeatability and reproducibility of a measurement, by analysis of variance (AIAG MSA, 4th edition).

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::study {

struct Reading {
  std::string part, person;
  double value{0};  ///< in any unit; all results are in it, too
};

/// A row of the analysis.
struct Source {
  double squares{0};  ///< sum of squares
  int freedom{0};
  [[nodiscard]] double mean_square() const { return squares / freedom; }
};

struct GageStudy {
  int parts{0}, persons{0}, trials{0};
  Source of_parts{}, of_persons{}, of_both{}, of_repeats{};
  double interaction_probability{1};  ///< that chance alone makes as much interaction
  bool interaction_kept{false};       ///< else it is taken as repeats
  // Standard deviations.
  double ev{0};           ///< equipment: the same person, the same part
  double av{0};           ///< persons
  double interaction{0};  ///< 0 where it is not kept
  double grr{0};          ///< all three together
  double pv{0};           ///< parts
  double tv{0};           ///< everything
  int ndc{1};             ///< distinct categories that can be told apart: 1.41 PV / GRR, cut

  [[nodiscard]] double grr_percent() const { return tv > 0 ? 100 * grr / tv : 0; }
};

/// Fails: fewer than 2 parts, persons or trials; a person who did not measure each part as often; no spread
/// at all.
[[nodiscard]] Result<GageStudy> gage_study(std::span<const Reading> readings);

/// A table `#part,person,value`, one reading a row.
[[nodiscard]] Result<std::vector<Reading>> read_readings(const std::filesystem::path& file);

/// Probability that an F of these freedoms is larger by chance.  Pre: both at least 1, `ratio` not below 0.
struct Freedoms {
  int above{1}, below{1};
};
[[nodiscard]] double chance_of_larger(double ratio, const Freedoms& freedoms);

}  // namespace biteline::study
