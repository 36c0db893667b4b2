// SPDX-License-Identifier: MIT
#pragma once
/// \file Wear of a tool, told from the trend of what it leaves: part after part, since it was changed.
///
/// A straight line by least squares; its band by Student's t.  When a limit is reached is Fieller's theorem
/// (Draper and Smith, Applied Regression Analysis, 3rd edition, section 3.2), for the mean, not for one part.
/// The parts' errors are taken as independent of each other.

#include <optional>
#include <span>
#include <vector>

#include "common/core/result.hpp"
#include "host/study/performance.hpp"

namespace biteline::study {

/// value = intercept + slope * x, over x = 1, 2, ... or whatever was told.
struct Trend {
  int count{0};
  double intercept{0}, slope{0};
  double intercept_error{0}, slope_error{0};  ///< standard deviations
  double residual{0};                         ///< standard deviation about the line
  double slope_u95{0};                        ///< half of its interval of 95 %
  double mean_x{0}, squares_x{0};             ///< of x: its mean, and its squares about it

  /// The trend is no chance: its interval lacks 0.
  [[nodiscard]] bool sure() const { return slope > slope_u95 || slope < -slope_u95; }
  [[nodiscard]] double at(double x) const { return intercept + slope * x; }
};

struct TrendPoint {
  double x{0}, value{0};
};

/// Fails: fewer than 3 points, or all at one x.
[[nodiscard]] Result<Trend> trend_of(std::span<const TrendPoint> points);

/// Of several series with one slope and a level of its own for each, as an analysis of covariance has it: the
/// slope within the groups (Draper and Smith, section 14.3).  Intercept and mean are of all points.
/// Fails: fewer than 2 points more than groups, or all at one x within each.
[[nodiscard]] Result<Trend> trend_within(std::span<const std::vector<TrendPoint>> groups);

/// Where the mean reaches the limit that it goes to; in x.
struct Crossing {
  double limit{0};
  double likely{0};
  double earliest{0}, latest{0};  ///< of the interval of 95 %
};
/// Nothing where the trend is not sure.  Already reached: `likely` lies behind.
[[nodiscard]] std::optional<Crossing> crossing_of(const Trend& trend, const Limits& limits);

/// Student's t: beyond it on either side lie 5 % together.  Pre: freedom at least 1.
[[nodiscard]] double student_95(int freedom);

}  // namespace biteline::study
