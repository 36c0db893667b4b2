// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/chains.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include <tbb/parallel_for.h>

namespace biteline::bite_line {

namespace {

constexpr int k_none = -1;

/// The highest place of a crease in its column.
struct Crest {
  int row;
  int col;
  float likeness;
  int next{k_none};  ///< index of the crest that goes on in a later column
  int last{k_none};  ///< and of that which came before
};

class Chains {
 public:
  Chains(const SideGrid& grid, std::span<const float> likeness, const ChainConfig& config)
      : grid_{grid}, config_{config}, apart_rows_{rows_of(config.apart_mm)} {
    std::vector<std::vector<int>> rows(static_cast<std::size_t>(grid.cols));
    tbb::parallel_for(0, grid.cols, [&](int col) {
      rows[static_cast<std::size_t>(col)] =
          crests_of(likeness.subspan(grid.at(0, col), static_cast<std::size_t>(grid.rows)));
    });
    for (int col = 0; col < grid.cols; ++col) {
      first_.push_back(static_cast<int>(crests_.size()));
      for (const int row : rows[static_cast<std::size_t>(col)])
        crests_.push_back({.row = row, .col = col, .likeness = likeness[grid.at(row, col)]});
    }
    first_.push_back(static_cast<int>(crests_.size()));
    for (int col = 0; col < grid.cols; ++col) join_neighbours(col);
    bridge();
    close_laps();
  }

  [[nodiscard]] Large<float> shares() const {
    Large<float> shares(grid_.size());
    std::fill(shares.begin(), shares.end(), 0.0F);
    const std::vector<float> round = rounds();
    for (std::size_t i = 0; i < crests_.size(); ++i) {
      const Crest& crest = crests_[i];
      for (int row = std::max(0, crest.row - apart_rows_);
           row <= std::min(grid_.rows - 1, crest.row + apart_rows_); ++row) {
        float& share = shares[grid_.at(row, crest.col)];
        share = std::max(share, round[i]);
      }
    }
    return shares;
  }

 private:
  [[nodiscard]] int rows_of(double mm) const {
    return std::max(1, static_cast<int>(std::lround(mm / grid_.row_mm)));
  }

  [[nodiscard]] std::vector<int> crests_of(std::span<const float> column) const {
    std::vector<int> rows;
    const auto count = static_cast<int>(column.size());
    for (int row = 0; row < count; ++row) {
      const float value = column[static_cast<std::size_t>(row)];
      if (value < config_.least_likeness) continue;
      bool highest = true;
      for (int r = std::max(0, row - apart_rows_); highest && r <= std::min(count - 1, row + apart_rows_);
           ++r) {
        const float other = column[static_cast<std::size_t>(r)];
        highest = other < value || (other == value && r >= row);  // of equal ones the lowest row
      }
      if (highest) rows.push_back(row);
    }
    return rows;
  }

  [[nodiscard]] std::size_t column_after(int col) const {
    return static_cast<std::size_t>((col + 1) % grid_.cols);
  }

  /// The crest of a column nearest to a row, within reach.
  [[nodiscard]] int nearest(std::size_t col, int row, int reach_rows) const {
    int best = k_none;
    int least = reach_rows + 1;
    for (int i = first_[col]; i < first_[col + 1]; ++i) {
      const int away = std::abs(crests_[static_cast<std::size_t>(i)].row - row);
      if (away >= least) continue;
      least = away;
      best = i;
    }
    return best;
  }

  void join(int before, int after) {
    crests_[static_cast<std::size_t>(before)].next = after;
    crests_[static_cast<std::size_t>(after)].last = before;
  }

  void join_neighbours(int col) {
    const int reach = rows_of(config_.smooth_mm * grid_.col_mm);
    const auto here = static_cast<std::size_t>(col);
    const std::size_t there = column_after(col);
    for (int i = first_[here]; i < first_[here + 1]; ++i) {
      const int row = crests_[static_cast<std::size_t>(i)].row;
      const int other = nearest(there, row, reach);
      if (other == k_none) continue;
      if (nearest(here, crests_[static_cast<std::size_t>(other)].row, reach) == i) join(i, other);
    }
  }

  /// Columns from one crest on to another, once round at most.
  [[nodiscard]] int cols_on(const Crest& from, const Crest& to) const {
    return (to.col - from.col + grid_.cols) % grid_.cols;
  }

  [[nodiscard]] double rise_mm(const Crest& from, const Crest& to) const {
    return std::abs(to.row - from.row) * grid_.row_mm;
  }

  [[nodiscard]] int most_gap_cols() const { return static_cast<int>(config_.bridge_mm / grid_.col_mm); }

  /// Two ends that face each other over a gap.
  struct Ends {
    int before, after;
    double cost;
  };
  /// Nothing where a crease that ends at one cannot go on at the other.
  [[nodiscard]] std::optional<Ends> ends_of(std::size_t before, std::size_t after) const {
    const Crest& from = crests_[before];
    const Crest& to = crests_[after];
    const int gap = cols_on(from, to);
    const double gap_mm = gap * grid_.col_mm;
    const double rise = rise_mm(from, to);
    if (gap < 1 || gap > most_gap_cols() || rise > config_.step_mm + config_.bridge_rise * gap_mm)
      return std::nullopt;
    // A millimetre up counts as much as five along: creases run on as they were.
    return Ends{
        .before = static_cast<int>(before), .after = static_cast<int>(after), .cost = gap_mm + 5 * rise};
  }

  void bridge() {
    const int most_cols = most_gap_cols();
    std::vector<Ends> pairs;
    std::vector<int> begins;  // by column
    for (std::size_t i = 0; i < crests_.size(); ++i) {
      if (crests_[i].last == k_none) begins.push_back(static_cast<int>(i));
    }
    const auto col_of = [&](int crest) { return crests_[static_cast<std::size_t>(crest)].col; };
    const auto from_col = [&](int col) {
      return std::partition_point(begins.begin(), begins.end(),
                                  [&](int begin) { return col_of(begin) < col; });
    };
    const auto add_pairs = [&](std::size_t before, auto first, auto end) {
      for (; first != end; ++first) {
        if (const auto pair = ends_of(before, static_cast<std::size_t>(*first))) pairs.push_back(*pair);
      }
    };
    for (std::size_t i = 0; i < crests_.size(); ++i) {
      if (crests_[i].next != k_none) continue;
      const int col = crests_[i].col;
      // What lies within reach behind the seam, then what lies before it.
      const int behind = std::min(col - 1, col + most_cols - grid_.cols);
      add_pairs(i, begins.begin(), from_col(behind + 1));
      add_pairs(i, from_col(col + 1), from_col(std::min(grid_.cols, col + most_cols + 1)));
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Ends& a, const Ends& b) { return a.cost < b.cost; });
    for (const Ends& pair : pairs) {
      if (crests_[static_cast<std::size_t>(pair.before)].next == k_none &&
          crests_[static_cast<std::size_t>(pair.after)].last == k_none)
        join(pair.before, pair.after);
    }
  }

  [[nodiscard]] bool is_bridged(const Crest& crest) const {
    if (crest.next == k_none) return false;
    const Crest& next = crests_[static_cast<std::size_t>(crest.next)];
    return cols_on(crest, next) > 1 || rise_mm(crest, next) > config_.smooth_mm * grid_.col_mm;
  }

  /// A crease that goes round closes on itself.  A chain that is longer than the way round does not: over a
  /// gap it went on along another crease, though a piece of its own faces it there.
  void close_laps() {
    for (std::size_t first = 0; first < crests_.size(); ++first) {
      if (crests_[first].last == k_none) close_lap(first);
    }
  }

  void close_lap(std::size_t first) {
    struct End {
      std::size_t crest;
      int way;  // columns from the chain's begin
    };
    std::vector<End> begins{{.crest = first, .way = 0}};
    std::vector<End> ends;
    End here = begins.front();
    while (crests_[here.crest].next != k_none) {
      const auto next = static_cast<std::size_t>(crests_[here.crest].next);
      const int way = here.way + cols_on(crests_[here.crest], crests_[next]);
      if (is_bridged(crests_[here.crest])) {
        ends.push_back(here);
        begins.push_back({.crest = next, .way = way});
      }
      here = {.crest = next, .way = way};
    }
    ends.push_back(here);
    if (here.way < grid_.cols) return;
    std::optional<Ends> best;
    for (const End& end : ends) {
      for (const End& begin : begins) {
        const int way = end.way - begin.way;
        if (way < grid_.cols - most_gap_cols() || way >= grid_.cols) continue;
        const std::optional<Ends> pair = ends_of(end.crest, begin.crest);
        if (pair && (!best || pair->cost < best->cost)) best = pair;
      }
    }
    if (!best) return;
    const int tail = crests_[static_cast<std::size_t>(best->before)].next;
    const int head = crests_[static_cast<std::size_t>(best->after)].last;
    if (tail != k_none) crests_[static_cast<std::size_t>(tail)].last = k_none;
    if (head != k_none) crests_[static_cast<std::size_t>(head)].next = k_none;
    join(best->before, best->after);
  }

  /// Of each crest's chain the share of the way round on which it is about as strong as at the crest.  A gap
  /// that is bridged is as strong as the crest before it.
  [[nodiscard]] std::vector<float> rounds() const {
    std::vector<float> round(crests_.size(), -1.0F);
    const auto walk = [&](std::size_t start) {
      std::vector<std::size_t> chain;
      std::vector<float> strengths;  // of each column that the chain spans
      for (std::size_t i = start;;) {
        chain.push_back(i);
        const int next = crests_[i].next;
        const int cols = next == k_none ? 1 : cols_on(crests_[i], crests_[static_cast<std::size_t>(next)]);
        strengths.insert(strengths.end(), static_cast<std::size_t>(cols), crests_[i].likeness);
        if (next == k_none) break;
        i = static_cast<std::size_t>(next);
        if (i == start || chain.size() > crests_.size()) break;
      }
      std::sort(strengths.begin(), strengths.end());
      for (const std::size_t i : chain) {
        const float least = config_.as_strong_ratio * crests_[i].likeness;
        const auto cols = static_cast<double>(strengths.end() -
                                              std::lower_bound(strengths.begin(), strengths.end(), least));
        round[i] = static_cast<float>(std::min(1.0, cols / grid_.cols));
      }
    };
    for (std::size_t i = 0; i < crests_.size(); ++i) {
      if (crests_[i].last == k_none) walk(i);
    }
    // What is left closes on itself.
    for (std::size_t i = 0; i < crests_.size(); ++i) {
      if (round[i] < 0) walk(i);
    }
    return round;
  }

  const SideGrid& grid_;
  const ChainConfig& config_;
  int apart_rows_;
  std::vector<Crest> crests_;  ///< column after column
  std::vector<int> first_;     ///< of each column, and the end
};

}  // namespace

Large<float> share_round(const SideGrid& grid, std::span<const float> likeness, const ChainConfig& config) {
  return Chains{grid, likeness, config}.shares();
}

}  // namespace biteline::bite_line
