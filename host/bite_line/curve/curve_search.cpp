// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <tbb/parallel_invoke.h>

#include "common/core/contracts.hpp"

namespace biteline::bite_line {

namespace {

constexpr int k_most_turn = 2;
constexpr std::int8_t k_begins = 127;  // a state without one before it
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

std::size_t turned(std::size_t direction, int by) {
  return (direction + k_directions + static_cast<std::size_t>(by + static_cast<int>(k_directions))) %
         k_directions;
}

double length_mm(std::size_t direction) {
  return Raster::k_cell_mm * k_cell_steps[direction].length();
}

float bend_cost(std::size_t direction, int turn, double bend_mm) {
  const auto angle = [](std::size_t k) { return std::atan2(k_cell_steps[k].rows, k_cell_steps[k].cols); };
  const std::size_t next = turned(direction, turn);
  const double by_rad = std::remainder(angle(next) - angle(direction), 2 * std::numbers::pi);
  return static_cast<float>(bend_mm * by_rad * by_rad / (0.5 * (length_mm(direction) + length_mm(next))));
}

/// Per column, what its cheapest place costs, and how much the next best one far from that costs more.
struct ColumnBest {
  float least;
  float margin;
};

ColumnBest best_of_column(const CurveCosts& costs, int col, int apart_rows) {
  std::vector<float> own(static_cast<std::size_t>(costs.rows), k_out_of_reach);
  ColumnBest best{k_out_of_reach, 0};
  int at = 0;
  for (int row = 0; row < costs.rows; ++row) {
    float& least = own[static_cast<std::size_t>(row)];
    for (const Large<float>& per_mm : costs.per_mm) least = std::min(least, per_mm[costs.at(row, col)]);
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

CurveSearch::CurveSearch(const CurveCosts& costs, const CurveConfig& config)
    : costs_{costs}, config_{config} {
  BITELINE_EXPECTS(costs.rows > 0 && costs.cols > 4);
  constexpr double k_pad_mm = 15;  // a curve may turn back over the column where it began
  pad_cols_ = std::min(static_cast<int>(k_pad_mm / Raster::k_cell_mm), costs.cols / 2);
  for (std::size_t k = 0; k < k_directions; ++k)
    for (int turn = -k_most_turn; turn <= k_most_turn; ++turn)
      bend_[k][static_cast<std::size_t>(turn + k_most_turn)] = bend_cost(k, turn, config.bend_mm);
  std::vector<ColumnBest> best;
  const int apart_rows = static_cast<int>(config.apart_mm / Raster::k_cell_mm);
  for (int col = 0; col < costs.cols; ++col) best.push_back(best_of_column(costs, col, apart_rows));
  begin_col_ = surest_col(best);
  for (std::size_t k = 0; k < k_directions; ++k) half_step_mm_[k] = static_cast<float>(0.5 * length_mm(k));
  for (int col = 0; col < costs.cols + 2 * pad_cols_ + 1; ++col)
    first_cell_.push_back(costs.at(0, round_col(begin_col_ - pad_cols_ + col, costs.cols)));
  to_end_ = bounds(Sense::Ahead);
}

Large<float> CurveSearch::bounds(Sense sense) const {
  const int rows = costs_.rows, all = static_cast<int>(first_cell_.size());
  const int from_col = sense == Sense::Ahead ? costs_.cols + pad_cols_ : pad_cols_;
  const int sign = sense == Sense::Ahead ? -1 : 1;
  Large<float> least(static_cast<std::size_t>(rows) * static_cast<std::size_t>(all));
  std::fill(least.begin(), least.end(), k_out_of_reach);
  const auto at = [&](int row, int col) {
    return static_cast<std::size_t>(col) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  };
  Open open;
  for (int row = 0; row < rows; ++row) {
    least[at(row, from_col)] = 0;
    open.push(0, static_cast<std::uint32_t>(at(row, from_col)));
  }
  std::uint32_t here = 0;
  while (open.pop(here)) {
    const int col = static_cast<int>(here) / rows, row = static_cast<int>(here) % rows;
    for (std::size_t k = 0; k < k_directions; ++k) {
      const int r = row + sign * k_cell_steps[k].rows, c = col + sign * k_cell_steps[k].cols;
      if (r < 0 || r >= rows || c < 0 || c >= all) continue;
      const float sum = least[here] + step_cost(k, row, col, r, c);
      float& there = least[at(r, c)];
      if (sum >= there) continue;
      there = sum;
      open.push(sum, static_cast<std::uint32_t>(at(r, c)));
    }
  }
  return least;
}

std::size_t CurveSearch::index(const CurveState& state) const {
  const auto col = static_cast<std::size_t>(state.col - begin_col_ + pad_cols_);
  return (col * static_cast<std::size_t>(costs_.rows) + static_cast<std::size_t>(state.row)) * k_directions +
         state.direction;
}

CurveState CurveSearch::state_of(std::size_t index) const {
  const std::size_t place = index / k_directions;
  const auto rows = static_cast<std::size_t>(costs_.rows);
  return {.row = static_cast<int>(place % rows),
          .col = static_cast<int>(place / rows) + begin_col_ - pad_cols_,
          .direction = index % k_directions};
}

float CurveSearch::step_cost(std::size_t direction, int row, int col, int to_row, int to_col) const {
  const Large<float>& per_mm = costs_.per_mm[direction];
  const std::size_t here = first_cell_[static_cast<std::size_t>(col)] + static_cast<std::size_t>(row);
  const std::size_t there = first_cell_[static_cast<std::size_t>(to_col)] + static_cast<std::size_t>(to_row);
  return half_step_mm_[direction] * (per_mm[here] + per_mm[there]);
}

template <class Reach>
void CurveSearch::for_next(Sense sense, std::size_t index_here, float total, Reach&& reach) const {
  const std::size_t direction = index_here % k_directions, place = index_here / k_directions;
  const int rows = costs_.rows, all = static_cast<int>(first_cell_.size());
  const int here_col = static_cast<int>(place) / rows, here_row = static_cast<int>(place) % rows;
  const auto next = [&](std::size_t k, int sign, auto&& use) {
    const int row = here_row + sign * k_cell_steps[k].rows, col = here_col + sign * k_cell_steps[k].cols;
    if (row < 0 || row >= rows || col < 0 || col >= all) return;
    use(static_cast<std::size_t>(col) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row),
        total + step_cost(k, here_row, here_col, row, col));
  };
  if (sense == Sense::Ahead) {
    next(direction, 1, [&](std::size_t there, float sum) {
      for (int turn = -k_most_turn; turn <= k_most_turn; ++turn) {
        const float bend = bend_[direction][static_cast<std::size_t>(turn + k_most_turn)];
        reach(there, turned(direction, turn), sum + bend, static_cast<std::int8_t>(turn));
      }
    });
    return;
  }
  for (int turn = -k_most_turn; turn <= k_most_turn; ++turn) {
    const std::size_t k = turned(direction, -turn);
    const float bend = bend_[k][static_cast<std::size_t>(turn + k_most_turn)];
    next(k, -1,
         [&](std::size_t there, float sum) { reach(there, k, sum + bend, static_cast<std::int8_t>(turn)); });
  }
}

CurveSearch::Totals CurveSearch::sweep(Sense sense, const Ends& ends, const Large<float>& bound) const {
  Totals totals;
  const std::size_t states = bound.size() * k_directions;
  totals.total.resize(states);
  std::fill(totals.total.begin(), totals.total.end(), k_out_of_reach);
  totals.turn.resize(states);
  std::vector<std::uint8_t> goal(ends.all ? 0 : states, 0);
  if (!ends.all)
    for (const CurveState& state : ends.to) goal[index(state)] = 1;
  Open open;
  for (const CurveState& state : ends.from) {
    const std::size_t at = index(state);
    totals.total[at] = 0;
    totals.turn[at] = k_begins;
    open.push(bound[at / k_directions], static_cast<std::uint32_t>(at));
  }
  std::vector<std::uint8_t> done(states, 0);
  std::uint32_t here = 0;
  while (open.pop(here)) {
    if (done[here] != 0) continue;
    done[here] = 1;
    if (!ends.all && goal[here] != 0) {
      totals.end = here;
      totals.reached = true;
      break;
    }
    for_next(sense, here, totals.total[here],
             [&](std::size_t place, std::size_t direction, float total, std::int8_t turn) {
               const float key = total + bound[place];
               const std::size_t there = place * k_directions + direction;
               if (total >= totals.total[there] || key >= ends.limit) return;
               totals.total[there] = total;
               totals.turn[there] = turn;
               done[there] = 0;
               open.push(key, static_cast<std::uint32_t>(there));
             });
  }
  return totals;
}

std::vector<CurveState> CurveSearch::states_at(int row, int col, int about) const {
  std::vector<CurveState> states;
  for (int by = -about; by <= about; ++by) states.push_back({row, col, turned(0, by)});
  return states;
}

std::vector<CurveState> CurveSearch::traced(const Totals& totals) const {
  std::vector<CurveState> states{state_of(totals.end)};
  for (std::size_t at = totals.end; totals.turn[at] != k_begins; at = index(states.back())) {
    const CurveState& here = states.back();
    const std::size_t k = turned(here.direction, -totals.turn[at]);
    states.push_back({here.row - k_cell_steps[k].rows, here.col - k_cell_steps[k].cols, k});
  }
  std::ranges::reverse(states);
  return states;
}

std::optional<ClosedCurve> CurveSearch::closed_at(int row, float limit) const {
  const Totals totals = sweep(Sense::Ahead,
                              {.from = states_at(row, begin_col_, k_most_turn),
                               .to = states_at(row, begin_col_ + costs_.cols, k_most_turn),
                               .limit = limit},
                              to_end_);
  if (!totals.reached) return std::nullopt;
  ClosedCurve curve{.states = traced(totals), .energy = static_cast<double>(totals.total[totals.end])};
  curve.states.pop_back();
  return curve;
}

std::optional<ClosedCurve> CurveSearch::through_column(const std::vector<int>& rows) const {
  Ends ends{.from = {}, .to = {}, .limit = k_out_of_reach};
  for (const int row : rows) {
    for (const CurveState& state : states_at(row, begin_col_, k_most_turn)) ends.from.push_back(state);
    for (const CurveState& state : states_at(row, begin_col_ + costs_.cols, k_most_turn))
      ends.to.push_back(state);
  }
  const Totals open = sweep(Sense::Ahead, ends, to_end_);
  if (!open.reached) return std::nullopt;
  std::vector<CurveState> states = traced(open);
  const int first = states.front().row, last = states.back().row;
  if (first == last) {
    states.pop_back();
    return ClosedCurve{.states = std::move(states), .energy = static_cast<double>(open.total[open.end])};
  }
  std::optional<ClosedCurve> one = closed_at(first, k_out_of_reach);
  const auto limit = one ? static_cast<float>(one->energy) : k_out_of_reach;
  std::optional<ClosedCurve> other = closed_at(last, limit);
  return other && (!one || other->energy < one->energy) ? other : one;
}

std::optional<ClosedCurve> CurveSearch::best() const {
  std::vector<int> rows;
  for (int row = 0; row < costs_.rows; ++row) rows.push_back(row);
  return through_column(rows);
}

std::optional<ClosedCurve> CurveSearch::other_than(const ClosedCurve& curve) const {
  std::vector<int> rows;
  for (int row = 0; row < costs_.rows; ++row) {
    const double away_mm = std::abs(row - curve.states.front().row) * Raster::k_cell_mm;
    if (away_mm > config_.apart_mm) rows.push_back(row);
  }
  if (rows.empty()) return std::nullopt;
  return through_column(rows);
}

Large<float> CurveSearch::excess_about(const ClosedCurve& curve) const {
  const int row = curve.states.front().row;
  const auto energy = static_cast<float>(curve.energy);
  const float limit = energy + config_.rival_excess;
  const std::vector<CurveState> begin = states_at(row, begin_col_, k_most_turn);
  const std::vector<CurveState> end = states_at(row, begin_col_ + costs_.cols, k_most_turn);
  Totals ahead, back;
  tbb::parallel_invoke(
      [&] { ahead = sweep(Sense::Ahead, {.from = begin, .to = {}, .limit = limit, .all = true}, to_end_); },
      [&] {
        back = sweep(Sense::Back, {.from = end, .to = {}, .limit = limit, .all = true}, bounds(Sense::Back));
      });
  Large<float> excess(static_cast<std::size_t>(costs_.rows) * static_cast<std::size_t>(costs_.cols));
  std::fill(excess.begin(), excess.end(), k_out_of_reach);
  for (std::size_t state = 0; state < ahead.total.size(); ++state) {
    if (ahead.total[state] == k_out_of_reach || back.total[state] == k_out_of_reach) continue;
    const CurveState at = state_of(state);
    float& least = excess[costs_.at(at.row, round_col(at.col, costs_.cols))];
    least = std::clamp(ahead.total[state] + back.total[state] - energy, 0.0F, least);
  }
  return excess;
}

}  // namespace biteline::bite_line
