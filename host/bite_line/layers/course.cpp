// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/course.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <tbb/parallel_invoke.h>

#include "common/core/contracts.hpp"
#include "host/bite_line/lanes.hpp"
#include "host/bite_line/large.hpp"

namespace biteline::bite_line {

namespace {

constexpr float k_blocked = 1e30F;

/// Totals of the cheapest ways to each place, twice round in one direction; those of the second round count.
class Totals {
 public:
  /// `ahead`: from low columns to high ones.
  Totals(std::span<const float> cost, int rows, int cols, bool ahead, const PathConfig& config)
      : rows_{static_cast<std::size_t>(rows)}, cols_{cols}, ahead_{ahead} {
    const int count = 2 * cols;
    total_.resize(rows_ * static_cast<std::size_t>(cols));
    step_.resize(rows_ * static_cast<std::size_t>(count));
    const auto reach = static_cast<std::size_t>(config.max_step_rows);
    std::vector<float> before(rows_ + 2 * reach, k_blocked), after = before, penalty;
    for (int d = -config.max_step_rows; d <= config.max_step_rows; ++d)
      penalty.push_back(static_cast<float>(config.step_cost * d * d));
    std::copy_n(cost.data() + at(0), rows_, before.data() + reach);
    std::fill_n(step_.data(), rows_, std::int8_t{0});
    for (int k = 1; k < count; ++k) {
      step_column({.before = before.data() + reach,
                   .penalty = penalty,
                   .own = cost.data() + at(k),
                   .most = k_blocked},
                  {after.data() + reach, rows_}, step_.data() + static_cast<std::size_t>(k) * rows_);
      std::swap(before, after);
      if (k >= cols) std::copy_n(before.data() + reach, rows_, total_.data() + at(k));
    }
  }

  [[nodiscard]] float total(int row, int col) const {
    return total_[static_cast<std::size_t>(col) * rows_ + static_cast<std::size_t>(row)];
  }
  /// Columns of the way to a column of the second round.
  [[nodiscard]] int length(int col) const { return cols_ + 1 + (ahead_ ? col : cols_ - 1 - col); }
  /// Row of the way one column before the `k`-th from the sweep's start.
  [[nodiscard]] int before(int row, int k) const {
    return row + step_[static_cast<std::size_t>(k) * rows_ + static_cast<std::size_t>(row)];
  }

 private:
  /// First cell of the k-th column that the sweep comes to.
  [[nodiscard]] std::size_t at(int k) const {
    const int col = k % cols_;
    return static_cast<std::size_t>(ahead_ ? col : cols_ - 1 - col) * rows_;
  }

  std::size_t rows_;
  int cols_;
  bool ahead_;
  Large<float> total_;
  Large<std::int8_t> step_;
};

class Search {
 public:
  Search(std::span<const float> cost, int rows, int cols, const CourseConfig& config)
      : cost_{cost}, rows_{rows}, cols_{cols}, config_{config} {
    tbb::parallel_invoke([&] { ahead_.emplace_back(cost, rows, cols, true, config.path); },
                         [&] { back_.emplace_back(cost, rows, cols, false, config.path); });
  }

  Course run(const ClosedPath& best) {
    Course course;
    course.row = best.row;
    course.cost = best.cost;
    Branch over;
    Branch under;
    tbb::parallel_invoke([&] { over = beside(course, true); }, [&] { under = beside(course, false); });
    for (const bool above : {true, false}) add_branches(course, above);
    course.branches.push_back(std::move(over));
    course.branches.push_back(std::move(under));
    std::stable_sort(course.branches.begin(), course.branches.end(), [](const Branch& a, const Branch& b) {
      return a.worse * b.over_cols < b.worse * a.over_cols;
    });
    return course;
  }

 private:
  [[nodiscard]] float through(int row, int col) const {
    return ahead_.front().total(row, col) + back_.front().total(row, col) - cost_at(row, col);
  }
  [[nodiscard]] float cost_at(int row, int col) const {
    return cost_[static_cast<std::size_t>(col) * static_cast<std::size_t>(rows_) +
                 static_cast<std::size_t>(row)];
  }

  struct Rival {
    int row{-1};
    int col{-1};
    double worse{0};
  };
  /// Creases of the column that lie apart from the course: where the cheapest course through a place is the
  /// cheapest about it, and the place itself shows something.
  void add_rivals_at(const Course& course, int col, bool above, std::vector<Rival>& rivals) const {
    constexpr int k_about_rows = 3;
    const int own = course.row[static_cast<std::size_t>(col)];
    const float least = through(own, col);
    const int first = above ? own + config_.apart_rows : 0;
    const int end = above ? rows_ : own - config_.apart_rows + 1;
    for (int row = first; row < end; ++row) {
      if (cost_at(row, col) > config_.most_cost) continue;
      const float here = through(row, col);
      bool lowest = true;
      for (int r = std::max(first, row - k_about_rows); lowest && r <= std::min(end - 1, row + k_about_rows);
           ++r)
        lowest = through(r, col) >= here;
      if (lowest) rivals.push_back({.row = row, .col = col, .worse = static_cast<double>(here - least)});
    }
  }

  [[nodiscard]] int own_row(const Course& course, int col) const {
    return course.row[static_cast<std::size_t>((col % cols_ + cols_) % cols_)];
  }

  /// The whole way through a place, until it meets the course.
  [[nodiscard]] Branch trace(const Course& course, const Rival& rival, bool above) const {
    const int col = rival.col;
    constexpr int k_met_rows = 2;
    const auto met = [&](int row, int c) { return std::abs(row - own_row(course, c)) <= k_met_rows; };
    const auto walk = [&](const Totals& totals, int direction) {
      std::vector<int> rows;
      int row = rival.row;
      int c = col;
      for (int k = totals.length(col) - 1; k > 0; --k) {
        row = totals.before(row, k);
        c += direction;
        if (met(row, c)) break;
        rows.push_back(row);
      }
      return rows;
    };
    std::vector<int> left = walk(ahead_.front(), -1);
    const std::vector<int> right = walk(back_.front(), 1);
    Branch branch{.first_col = 0,
                  .row = {},
                  .above = above,
                  .worse = rival.worse,
                  .over_cols = static_cast<double>(left.size() + right.size() + 1)};
    // Once round is enough to draw it.
    if (branch.over_cols >= cols_) left.resize(std::min(left.size(), static_cast<std::size_t>(cols_ / 2)));
    branch.first_col = ((col - static_cast<int>(left.size())) % cols_ + cols_) % cols_;
    branch.row.assign(left.rbegin(), left.rend());
    branch.row.push_back(rival.row);
    for (const int row : right) {
      if (branch.row.size() >= static_cast<std::size_t>(cols_)) break;
      branch.row.push_back(row);
    }
    return branch;
  }

  void add_branches(Course& course, bool above) const {
    std::vector<Rival> rivals;
    for (int col = 0; col < cols_; ++col) add_rivals_at(course, col, above, rivals);
    std::stable_sort(rivals.begin(), rivals.end(),
                     [](const Rival& a, const Rival& b) { return a.worse < b.worse; });
    constexpr int k_same_rows = 3;
    std::vector<std::uint8_t> known(cost_.size(), 0);
    const auto cell = [&](int row, int col) {
      return static_cast<std::size_t>(col) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(row);
    };
    int found = 0;
    for (const Rival& rival : rivals) {
      if (known[cell(rival.row, rival.col)] != 0) continue;
      if (++found > config_.most) break;
      Branch branch = trace(course, rival, above);
      for (std::size_t k = 0; k < branch.row.size(); ++k) {
        const int col = (branch.first_col + static_cast<int>(k)) % cols_;
        for (int row = std::max(0, branch.row[k] - k_same_rows);
             row <= std::min(rows_ - 1, branch.row[k] + k_same_rows); ++row)
          known[cell(row, col)] = 1;
      }
      course.branches.push_back(std::move(branch));
    }
  }

  /// The best closed course that lies wholly above, or below: it never comes back.
  [[nodiscard]] Branch beside(const Course& course, bool above) const {
    constexpr float k_barred = 100.0F;
    Large<float> cost(cost_.size());
    std::copy(cost_.begin(), cost_.end(), cost.begin());
    for (int col = 0; col < cols_; ++col) {
      const int own = course.row[static_cast<std::size_t>(col)];
      float* column = cost.data() + static_cast<std::size_t>(col) * static_cast<std::size_t>(rows_);
      const int first = above ? 0 : std::max(0, own - config_.apart_rows);
      const int end = above ? std::min(rows_, own + config_.apart_rows) : rows_;
      std::fill(column + first, column + end, k_barred);
    }
    const ClosedPath path = shortest_closed_path({cost.data(), cost.size()}, rows_, cols_, config_.path);
    return {.first_col = 0,
            .row = path.row,
            .above = above,
            .worse = path.cost - course.cost,
            .over_cols = static_cast<double>(cols_)};
  }

  std::span<const float> cost_;
  int rows_;
  int cols_;
  CourseConfig config_;
  std::vector<Totals> ahead_, back_;
};

}  // namespace

Course find_course(std::span<const float> cost, int rows, int cols, const ClosedPath& best,
                   const CourseConfig& config) {
  BITELINE_EXPECTS(rows > 0 && cols > 1 &&
                   cost.size() == static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
  BITELINE_EXPECTS(best.row.size() == static_cast<std::size_t>(cols));
  return Search{cost, rows, cols, config}.run(best);
}

}  // namespace biteline::bite_line
