// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "common/core/contracts.hpp"

namespace biteline::bite_line {

namespace {

// Of a state: its turn, two more than it is; that it has none before it; that it was looked at.
constexpr std::uint8_t k_turn = 7, k_begins = 7, k_done = 8;
constexpr float k_out_of_reach = std::numeric_limits<float>::max();

/// States by what they cost, in steps so fine that their order within one hardly matters: a state that is
/// found cheaper later is taken again.
class Open {
 public:
  void push(float key, std::uint32_t state) {
    const auto at = static_cast<std::size_t>(key / k_width);
    if (at >= buckets_.size()) buckets_.resize(at + at / 2 + 1);
    buckets_[at].push_back(state);
    first_ = std::min(first_, at);
  }
  /// False where nothing is left.
  [[nodiscard]] bool pop(std::uint32_t& state) {
    while (first_ < buckets_.size() && buckets_[first_].empty()) ++first_;
    if (first_ >= buckets_.size()) return false;
    state = buckets_[first_].back();
    buckets_[first_].pop_back();
    return true;
  }

 private:
  static constexpr float k_width = 0.05F;
  std::vector<std::vector<std::uint32_t>> buckets_;
  std::size_t first_{0};
};

int round_col(int col, int cols) {
  return ((col % cols) + cols) % cols;
}

/// Beyond k_directions where that leads back.
std::size_t turned(std::size_t direction, int by) {
  return direction + static_cast<std::size_t>(by);
}

/// A curve crosses the column where it begins nearly level.
bool nearly_level(std::size_t direction) {
  return direction + k_most_turn >= k_level_direction && direction <= k_level_direction + k_most_turn;
}

double length_mm(std::size_t direction) {
  return Raster::k_cell_mm * k_cell_steps[direction].length();
}

/// Per column, what its cheapest place costs, and how much the next best one far from that costs more.
struct ColumnBest {
  float least;
  float margin;
};

ColumnBest best_of_column(const CurveCosts& costs, std::span<const float> dearer, int col, int apart_rows) {
  std::vector<float> own(static_cast<std::size_t>(costs.rows));
  ColumnBest best{k_out_of_reach, 0};
  int at = 0;
  for (int row = 0; row < costs.rows; ++row) {
    const std::size_t cell = costs.at(row, col);
    float& least = own[static_cast<std::size_t>(row)];
    least = costs.least(cell) + (dearer.empty() ? 0.0F : dearer[cell]);
    if (least >= best.least) continue;
    best.least = least;
    at = row;
  }
  float other = k_most_cost_per_mm;
  for (int row = 0; row < costs.rows; ++row)
    if (std::abs(row - at) > apart_rows) other = std::min(other, own[static_cast<std::size_t>(row)]);
  best.margin = other - best.least;
  return best;
}

/// The column about which the cheapest places are told best from all others.
int surest_col(std::span<const ColumnBest> best) {
  constexpr int k_about_cols = 13;  // some 10 mm to both sides
  const int cols = static_cast<int>(best.size());
  const int about = std::min(k_about_cols, cols / 4);
  float most = -k_out_of_reach;
  int at = 0;
  for (int col = 0; col < cols; ++col) {
    float sum = 0;
    for (int c = col - about; c <= col + about; ++c)
      sum += best[static_cast<std::size_t>((c + cols) % cols)].margin;
    if (sum <= most) continue;
    most = sum;
    at = col;
  }
  return at;
}

}  // namespace

float bend_cost(std::size_t direction, int turn, double bend_mm) {
  const auto angle = [](std::size_t k) { return std::atan2(k_cell_steps[k].rows, k_cell_steps[k].cols); };
  const std::size_t next = turned(direction, turn);
  if (next >= k_directions) return 0;
  const double by_rad = std::remainder(angle(next) - angle(direction), 2 * std::numbers::pi);
  return static_cast<float>(bend_mm * by_rad * by_rad / (0.5 * (length_mm(direction) + length_mm(next))));
}

double length_of(std::span<const CurveState> states) {
  double sum_mm = 0;
  for (std::size_t i = 0; i + 1 < states.size(); ++i) sum_mm += length_mm(states[i].direction);
  return sum_mm;
}

double energy_of(std::span<const CurveState> states, const CurveCosts& costs, const CurveConfig& config) {
  const auto per_mm = [&](const CurveState& at, std::size_t direction) {
    return static_cast<double>(costs.of(costs.at(at.row, round_col(at.col, costs.cols)), direction));
  };
  double sum = 0;
  for (std::size_t i = 0; i + 1 < states.size(); ++i) {
    const std::size_t k = states[i].direction;
    sum += 0.5 * length_mm(k) * (per_mm(states[i], k) + per_mm(states[i + 1], k));
    const int turn = static_cast<int>(states[i + 1].direction) - static_cast<int>(k);
    if (i + 2 < states.size()) sum += static_cast<double>(bend_cost(k, turn, config.bend_mm));
  }
  return sum;
}

CurveSearch::CurveSearch(const CurveCosts& costs, const CurveConfig& config, std::span<const float> dearer)
    : costs_{costs}, dearer_{dearer}, config_{config} {
  BITELINE_EXPECTS(costs.rows > 0 && costs.cols > 4);
  constexpr double k_pad_mm = 15;  // a curve may turn back over the column where it began
  pad_cols_ = std::min(static_cast<int>(k_pad_mm / Raster::k_cell_mm), costs.cols / 2);
  for (std::size_t k = 0; k < k_directions; ++k)
    for (int turn = -k_most_turn; turn <= k_most_turn; ++turn)
      bend_[k][static_cast<std::size_t>(turn + k_most_turn)] = bend_cost(k, turn, config.bend_mm);
  std::vector<ColumnBest> best;
  const int apart_rows = static_cast<int>(config.apart_mm / Raster::k_cell_mm);
  for (int col = 0; col < costs.cols; ++col) best.push_back(best_of_column(costs, dearer, col, apart_rows));
  begin_col_ = surest_col(best);
  for (std::size_t k = 0; k < k_directions; ++k) half_step_mm_[k] = static_cast<float>(0.5 * length_mm(k));
  unrolled_cols_ = costs.cols + 2 * pad_cols_ + 1;
  for (int col = 0; col < unrolled_cols_; ++col)
    column_.push_back(costs.at(0, round_col(begin_col_ - pad_cols_ + col, costs.cols)));
  to_end_ = bounds();
}

PooledVector<float> CurveSearch::bounds() const {
  constexpr float k_beyond = 24;  // the bends of most curves cost no more
  const int rows = costs_.rows;
  PooledVector<float> least(static_cast<std::size_t>(rows) * static_cast<std::size_t>(unrolled_cols_));
  std::fill(least.begin(), least.end(), k_out_of_reach);
  const std::size_t from = costs_.at(0, costs_.cols + pad_cols_), to = costs_.at(0, pad_cols_);
  Open open;
  for (int row = 0; row < rows; ++row) {
    least[from + static_cast<std::size_t>(row)] = 0;
    open.push(0, static_cast<std::uint32_t>(from + static_cast<std::size_t>(row)));
  }
  float most = k_out_of_reach;
  std::uint32_t here = 0;
  while (open.pop(here)) {
    if (least[here] > most) break;
    if (most == k_out_of_reach && here >= to && here < to + static_cast<std::size_t>(rows))
      most = least[here] + k_beyond;
    const int col = static_cast<int>(here) / rows, row = static_cast<int>(here) % rows;
    for (std::size_t k = 0; k < k_directions; ++k) {
      const int r = row - k_cell_steps[k].rows, c = col - k_cell_steps[k].cols;
      if (r < 0 || r >= rows || c < 0 || c >= unrolled_cols_) continue;
      const std::size_t there = costs_.at(r, c);
      const float sum = least[here] + step_cost(k, row, col, r, c);
      if (sum >= least[there]) continue;
      least[there] = sum;
      open.push(sum, static_cast<std::uint32_t>(there));
    }
  }
  for (float& bound : least) bound = std::min(bound, most);
  return least;
}

std::size_t CurveSearch::index(const CurveState& state) const {
  return costs_.at(state.row, state.col - begin_col_ + pad_cols_) * k_directions + state.direction;
}

CurveState CurveSearch::state_of(std::size_t index) const {
  const std::size_t place = index / k_directions;
  const auto rows = static_cast<std::size_t>(costs_.rows);
  return {.row = static_cast<int>(place % rows),
          .col = static_cast<int>(place / rows) + begin_col_ - pad_cols_,
          .direction = index % k_directions};
}

template <class Reach>
void CurveSearch::for_next(std::size_t state, float total, Reach&& reach) const {
  const std::size_t direction = state % k_directions, here = state / k_directions;
  const int rows = costs_.rows;
  const int col = static_cast<int>(here) / rows, row = static_cast<int>(here) % rows;
  const int r = row + k_cell_steps[direction].rows, c = col + k_cell_steps[direction].cols;
  if (r < 0 || r >= rows || c < 0 || c >= unrolled_cols_) return;
  const std::size_t there = costs_.at(r, c);
  const float sum = total + step_cost(direction, row, col, r, c);
  for (int turn = -k_most_turn; turn <= k_most_turn; ++turn) {
    const std::size_t k = turned(direction, turn);
    if (k >= k_directions) continue;
    const auto by = static_cast<std::size_t>(turn + k_most_turn);
    reach(there * k_directions + k, sum + bend_[direction][by], static_cast<std::uint8_t>(by));
  }
}

CurveSearch::Totals CurveSearch::swept(std::span<const int> rows, float limit) const {
  Totals totals;
  const std::size_t cells = to_end_.size();
  totals.total.resize(cells * k_directions);
  totals.turn.resize(cells * k_directions);
  totals.reached_cell.resize(cells);
  std::ranges::fill(totals.reached_cell, std::uint8_t{0});
  const auto total_of = [&](std::size_t state) -> float& {
    const std::size_t cell = state / k_directions;
    if (std::exchange(totals.reached_cell[cell], std::uint8_t{1}) == 0)
      std::fill_n(totals.total.begin() + static_cast<std::ptrdiff_t>(cell * k_directions), k_directions,
                  k_out_of_reach);
    return totals.total[state];
  };
  Open open;
  std::vector<std::uint8_t> ends(static_cast<std::size_t>(costs_.rows), 0);
  for (const int row : rows) {
    ends[static_cast<std::size_t>(row)] = 1;
    for (std::size_t k = 0; k < k_directions; ++k) {
      const std::size_t at = index({row, begin_col_, k});
      const float key = to_end_[at / k_directions];
      if (!nearly_level(k) || key >= limit) continue;
      total_of(at) = 0;
      totals.turn[at] = k_begins;
      open.push(key, static_cast<std::uint32_t>(at));
    }
  }
  const std::size_t first_end = index({0, begin_col_ + costs_.cols, 0});
  const auto is_end = [&](std::size_t state) {
    const std::size_t row = (state - first_end) / k_directions;
    return state >= first_end && row < ends.size() && ends[row] != 0 && nearly_level(state % k_directions);
  };
  std::uint32_t here = 0;
  while (open.pop(here)) {
    if ((totals.turn[here] & k_done) != 0) continue;
    totals.turn[here] |= k_done;
    if (is_end(here)) {
      totals.end = here;
      totals.reached = true;
      break;
    }
    for_next(here, totals.total[here], [&](std::size_t there, float total, std::uint8_t turn) {
      const float key = total + to_end_[there / k_directions];
      if (key >= limit) return;
      float& known = total_of(there);
      if (total >= known) return;
      known = total;
      totals.turn[there] = turn;
      open.push(key, static_cast<std::uint32_t>(there));
    });
  }
  return totals;
}

std::vector<CurveState> CurveSearch::traced(const Totals& totals) const {
  std::vector<CurveState> states{state_of(totals.end)};
  for (std::size_t at = totals.end; (totals.turn[at] & k_turn) != k_begins; at = index(states.back())) {
    const CurveState& here = states.back();
    const std::size_t k = turned(here.direction, k_most_turn - (totals.turn[at] & k_turn));
    states.push_back({here.row - k_cell_steps[k].rows, here.col - k_cell_steps[k].cols, k});
  }
  std::ranges::reverse(states);
  return states;
}

std::optional<ClosedCurve> CurveSearch::through_column(std::span<const int> rows, float limit) const {
  const Totals open = swept(rows, limit);
  if (!open.reached) return std::nullopt;
  std::vector<CurveState> states = traced(open);
  const int first = states.front().row, last = states.back().row;
  if (first == last) {
    states.pop_back();
    return ClosedCurve{.states = std::move(states), .energy = static_cast<double>(open.total[open.end])};
  }
  // It does not close: no curve of these rows costs less, and none that closes has both of these ends.
  const auto middle = std::ranges::upper_bound(rows, (first + last) / 2);
  const auto below = static_cast<std::size_t>(middle - rows.begin());
  std::optional<ClosedCurve> one = through_column(rows.subspan(0, below), limit);
  constexpr double k_nearly = 0.998;  // of what is that near the cheapest, one is as good as the other
  std::optional<ClosedCurve> other =
      through_column(rows.subspan(below), one ? static_cast<float>(k_nearly * one->energy) : limit);
  return other ? other : one;
}

std::optional<ClosedCurve> CurveSearch::best(double limit) const {
  std::vector<int> rows(static_cast<std::size_t>(costs_.rows));
  std::iota(rows.begin(), rows.end(), 0);
  return through_column(rows, std::min(static_cast<float>(limit), k_out_of_reach));
}

}  // namespace biteline::bite_line
