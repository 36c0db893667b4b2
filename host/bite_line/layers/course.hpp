// SPDX-License-Identifier: MIT
#pragma once
/// \file The best closed course round the side, and what else the line could be, stretch by stretch.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/bite_line/large.hpp"
#include "host/bite_line/path/closed_path.hpp"

namespace biteline::bite_line {

/// Another way over a part of the course, or all the way round: it leaves the course and comes back.
struct Branch {
  int first_col{0};
  std::vector<int> row;  ///< from first_col on, modulo the columns; all of them where it never comes back
  bool above{false};
  double worse{0};      ///< how much more it costs than the course over the same columns ...
  double over_cols{0};  ///< ... and over how many that is counted, several rounds where it never comes back
};

struct Course {
  std::vector<int> row;  ///< per column
  double cost{0};
  std::vector<Branch> branches;  ///< nearest rivals first
};

struct CourseConfig {
  PathConfig path{.max_step_rows = 4, .step_cost = 0.03};
  int apart_rows{8};      ///< what is nearer is the same line
  float most_cost{0.8F};  ///< of a place that shows something
  int most{80};           ///< branches to a side
};

/// The cheapest ways to each place, by sweeps twice round in both directions.
class Ways {
 public:
  /// `cost` as shortest_closed_path() has it; borrowed: its numbers stay where they are.
  Ways(std::span<const float> cost, int rows, int cols, const PathConfig& config);

  /// shortest_closed_path() of that cost.
  [[nodiscard]] ClosedPath best() const;

  /// Of the cheapest course through a place, twice round and more.
  [[nodiscard]] float through(int row, int col) const {
    const std::size_t place = at(row, col);
    return ahead_.total[place] + back_.total[place] - cost_[place];
  }
  /// The rows of that course on one side of the place, from the next one on.
  template <class Take>
  void walk(int row, int col, bool ahead, Take&& take) const;

  [[nodiscard]] std::span<const float> cost() const { return cost_; }
  [[nodiscard]] float cost(int row, int col) const { return cost_[at(row, col)]; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return cols_; }

 private:
  /// Totals of the ways to each place in one direction; those of the second round count.
  struct Totals {
    Large<float> total;
    Large<std::int8_t> step;  ///< of both rounds in the order of the sweep: from a row to the one before
  };
  [[nodiscard]] Totals sweep(bool ahead) const;
  [[nodiscard]] std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(col) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(row);
  }
  /// Row of the way one column before the `k`-th from the sweep's start.
  [[nodiscard]] int before(const Totals& totals, int row, int k) const {
    return row + totals.step[at(row, k)];
  }

  std::span<const float> cost_;
  int rows_;
  int cols_;
  PathConfig config_;
  Totals ahead_, back_;
};

template <class Take>
void Ways::walk(int row, int col, bool ahead, Take&& take) const {
  // Its way came from there: the sweep ahead knows what lies behind.
  const Totals& totals = ahead ? back_ : ahead_;
  for (int k = cols_ + (ahead ? cols_ - 1 - col : col); k > 0; --k) {
    row = before(totals, row, k);
    if (!take(row)) break;
  }
}

/// The best course, and its rivals by the chain's min-marginals: for each place the cheapest course through
/// it.  Those that lie `apart_rows` and more away from the course at a column, on a place that shows
/// something, are its rivals there.
[[nodiscard]] Course find_course(const Ways& ways, const ClosedPath& best, const CourseConfig& config);

}  // namespace biteline::bite_line
