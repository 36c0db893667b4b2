// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/course.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_invoke.h>

#include "common/core/contracts.hpp"
#include "host/bite_line/lanes.hpp"
#include "host/bite_line/large.hpp"

namespace biteline::bite_line {

namespace {

class Search {
 public:
  Search(const Ways& ways, const CourseConfig& config)
      : ways_{ways}, rows_{ways.rows()}, cols_{ways.cols()}, config_{config} {}

  Course run(const ClosedPath& best) {
    Course course;
    course.row = best.row;
    course.cost = best.cost;
    Branch over;
    Branch under;
    std::vector<Branch> above;
    std::vector<Branch> below;
    tbb::parallel_invoke([&] { over = beside(course, true); }, [&] { under = beside(course, false); },
                         [&] { above = branches(course.row, true); },
                         [&] { below = branches(course.row, false); });
    course.branches = std::move(above);
    std::ranges::move(below, std::back_inserter(course.branches));
    course.branches.push_back(std::move(over));
    course.branches.push_back(std::move(under));
    std::stable_sort(course.branches.begin(), course.branches.end(), [](const Branch& a, const Branch& b) {
      return a.worse * b.over_cols < b.worse * a.over_cols;
    });
    return course;
  }

 private:
  struct Rival {
    int row{-1};
    int col{-1};
    double worse{0};
  };
  /// Creases of the column that lie apart from the course: where the cheapest course through a place is the
  /// cheapest about it, and the place itself shows something.
  void add_rivals_at(std::span<const int> course, int col, bool above, std::vector<Rival>& rivals) const {
    constexpr int k_about_rows = 3;
    const int own = course[static_cast<std::size_t>(col)];
    const float least = ways_.through(own, col);
    const int first = above ? own + config_.apart_rows : 0;
    const int end = above ? rows_ : own - config_.apart_rows + 1;
    for (int row = first; row < end; ++row) {
      if (ways_.cost(row, col) > config_.most_cost) continue;
      const float here = ways_.through(row, col);
      bool lowest = true;
      for (int r = std::max(first, row - k_about_rows); lowest && r <= std::min(end - 1, row + k_about_rows);
           ++r)
        lowest = ways_.through(r, col) >= here;
      if (lowest) rivals.push_back({.row = row, .col = col, .worse = static_cast<double>(here - least)});
    }
  }

  [[nodiscard]] int own_row(std::span<const int> course, int col) const {
    return course[static_cast<std::size_t>((col % cols_ + cols_) % cols_)];
  }

  /// The whole way through a place, until it meets the course.
  [[nodiscard]] Branch trace(std::span<const int> course, const Rival& rival, bool above) const {
    const int col = rival.col;
    constexpr int k_met_rows = 2;
    const auto met = [&](int row, int c) { return std::abs(row - own_row(course, c)) <= k_met_rows; };
    const auto walk = [&](bool ahead) {
      std::vector<int> rows;
      int c = col;
      ways_.walk(rival.row, col, ahead, [&](int row) {
        c += ahead ? 1 : -1;
        if (met(row, c)) return false;
        rows.push_back(row);
        return true;
      });
      return rows;
    };
    std::vector<int> left = walk(false);
    const std::vector<int> right = walk(true);
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

  [[nodiscard]] std::vector<Branch> branches(std::span<const int> course, bool above) const {
    std::vector<Branch> found;
    std::vector<Rival> rivals;
    for (int col = 0; col < cols_; ++col) add_rivals_at(course, col, above, rivals);
    std::stable_sort(rivals.begin(), rivals.end(),
                     [](const Rival& a, const Rival& b) { return a.worse < b.worse; });
    constexpr int k_same_rows = 3;
    std::vector<std::uint8_t> known(ways_.cost().size(), 0);
    const auto cell = [&](int row, int col) {
      return static_cast<std::size_t>(col) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(row);
    };
    for (const Rival& rival : rivals) {
      if (known[cell(rival.row, rival.col)] != 0) continue;
      if (found.size() == static_cast<std::size_t>(config_.most)) break;
      Branch branch = trace(course, rival, above);
      for (std::size_t k = 0; k < branch.row.size(); ++k) {
        const int col = (branch.first_col + static_cast<int>(k)) % cols_;
        for (int row = std::max(0, branch.row[k] - k_same_rows);
             row <= std::min(rows_ - 1, branch.row[k] + k_same_rows); ++row)
          known[cell(row, col)] = 1;
      }
      found.push_back(std::move(branch));
    }
    return found;
  }

  /// The best closed course that lies wholly above, or below: it never comes back.
  [[nodiscard]] Branch beside(const Course& course, bool above) const {
    constexpr float k_barred = 100.0F;
    // Rows that are barred all the way round are left out.
    const auto [lowest, highest] = std::minmax_element(course.row.begin(), course.row.end());
    const int first = above ? std::min(*lowest + config_.apart_rows, rows_ - 1) : 0;
    const int end = above ? rows_ : std::max(*highest - config_.apart_rows + 1, 1);
    const int height = end - first;
    Large<float> cost(static_cast<std::size_t>(height) * static_cast<std::size_t>(cols_));
    for (int col = 0; col < cols_; ++col) {
      const int own = course.row[static_cast<std::size_t>(col)];
      const int barred_to = above ? std::clamp(own + config_.apart_rows - first, 0, height) : height;
      const int barred_from = above ? 0 : std::clamp(own - config_.apart_rows, 0, height);
      float* column = cost.data() + static_cast<std::size_t>(col) * static_cast<std::size_t>(height);
      std::copy_n(
          ways_.cost().data() + static_cast<std::size_t>(col) * static_cast<std::size_t>(rows_) + first,
          height, column);
      std::fill(column + barred_from, column + barred_to, k_barred);
    }
    const ClosedPath path = shortest_closed_path({cost.data(), cost.size()}, height, cols_, config_.path);
    Branch branch{.first_col = 0,
                  .row = path.row,
                  .above = above,
                  .worse = path.cost - course.cost,
                  .over_cols = static_cast<double>(cols_)};
    for (int& row : branch.row) row += first;
    return branch;
  }

  const Ways& ways_;
  int rows_;
  int cols_;
  CourseConfig config_;
};

}  // namespace

Ways::Ways(std::span<const float> cost, int rows, int cols, const PathConfig& config)
    : cost_{cost}, rows_{rows}, cols_{cols}, config_{config} {
  BITELINE_EXPECTS(rows > 0 && cols > 1 &&
                   cost.size() == static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
  tbb::parallel_invoke([&] { ahead_ = sweep(true); }, [&] { back_ = sweep(false); });
}

Ways::Totals Ways::sweep(bool ahead) const {
  constexpr float k_blocked = 1e30F;
  const auto height = static_cast<std::size_t>(rows_);
  const int count = 2 * cols_;
  Totals totals;
  totals.total.resize(cost_.size());
  totals.step.resize(2 * cost_.size());
  /// First cell of the k-th column that the sweep comes to.
  const auto column = [&](int k) { return at(0, ahead ? k % cols_ : cols_ - 1 - k % cols_); };
  const auto reach = static_cast<std::size_t>(config_.max_step_rows);
  std::vector<float> before(height + 2 * reach, k_blocked), after = before, penalty;
  for (int d = -config_.max_step_rows; d <= config_.max_step_rows; ++d)
    penalty.push_back(static_cast<float>(config_.step_cost * d * d));
  std::copy_n(cost_.data() + column(0), height, before.data() + reach);
  std::fill_n(totals.step.data(), height, std::int8_t{0});
  for (int k = 1; k < count; ++k) {
    step_column({.before = before.data() + reach,
                 .penalty = penalty,
                 .own = cost_.data() + column(k),
                 .most = k_blocked},
                {after.data() + reach, height}, totals.step.data() + at(0, k));
    std::swap(before, after);
    const float* total = before.data() + reach;
    if (k >= cols_) std::copy_n(total, height, totals.total.data() + column(k));
  }
  return totals;
}

ClosedPath Ways::best() const {
  const float* last = ahead_.total.data() + at(0, cols_ - 1);
  auto row = static_cast<int>(std::min_element(last, last + rows_) - last);
  for (int k = 2 * cols_ - 1; k > cols_; --k) row = before(ahead_, row, k);
  return closed_path_through(cost_, rows_, cols_, row, config_);
}

Course find_course(const Ways& ways, const ClosedPath& best, const CourseConfig& config) {
  BITELINE_EXPECTS(best.row.size() == static_cast<std::size_t>(ways.cols()));
  return Search{ways, config}.run(best);
}

}  // namespace biteline::bite_line
