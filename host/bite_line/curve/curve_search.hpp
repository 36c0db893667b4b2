// SPDX-License-Identifier: MIT
#pragma once
/// \file The cheapest closed curve once round the side, in any direction and as straight as it can be.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/curve/curve_costs.hpp"
#include "host/bite_line/curve/raster.hpp"

namespace biteline::bite_line {

/// A curve is at a cell and leads on along a direction.
struct CurveState {
  int row{0};
  int col{0};  ///< beyond the last one, once round from where the curve began
  std::size_t direction{0};
};

struct ClosedCurve {
  std::vector<CurveState> states;  ///< once round; a step on from the last one is the first one, a turn on
  double energy{0};                ///< cost of its length and of its bends
};

struct CurveConfig {
  /// Of a bend: so much times the squared curvature for each millimetre.
  double bend_mm{1.0};
  /// A curve's place at the column where it begins is told from another one's so far away.
  double apart_mm{2.5};
};

/// From a state to the next one a curve turns by so many directions at most.
inline constexpr int k_most_turn = 2;
/// Of a bend from `direction` by `turn` directions; 0 where that leads back.
[[nodiscard]] float bend_cost(std::size_t direction, int turn, double bend_mm);

/// Of states one after the other, each a step from the one before: their length (mm), and what it costs.
[[nodiscard]] double length_of(std::span<const CurveState> states);
[[nodiscard]] double energy_of(std::span<const CurveState> states, const CurveCosts& costs,
                               const CurveConfig& config);

/// Dijkstra's search over (place, direction), begun and closed on one column.  The same without bends, over
/// places alone, bounds what is left (Hart, Nilsson, Raphael 1968), so that little beside good curves is
/// looked at.  The energy is that of Mirebeau 2018 on a grid; closing by one column cut: Appleton, Sun
/// 2003.
class CurveSearch {
 public:
  static constexpr double k_no_limit = 1e9;

  /// `dearer`: so much more a millimetre costs, per cell; empty: no more.  Both it and `costs` are borrowed.
  CurveSearch(const CurveCosts& costs, const CurveConfig& config, std::span<const float> dearer = {});

  /// The cheapest one, to two thousandths of what it costs; none where the side has none that costs less than
  /// `limit`.
  [[nodiscard]] std::optional<ClosedCurve> best(double limit = k_no_limit) const;

 private:
  /// What a sweep found, per state of the unrolled side.
  struct Totals {
    PooledVector<std::uint8_t> reached_cell;  ///< the totals of the others are not set
    PooledVector<float> total;
    PooledVector<std::uint8_t> turn;  ///< of the direction from the state before, see curve_search.cpp
    std::size_t end{0};               ///< where the cheapest way ends
    bool reached{false};
  };
  /// Per unrolled cell: what leads from it to the end's column costs at least, bends being free; what costs
  /// much more than the cheapest way round is only said to do so.
  [[nodiscard]] PooledVector<float> bounds() const;
  /// From `rows` to `rows`, once round; what costs more than `limit` is left out.
  [[nodiscard]] Totals swept(std::span<const int> rows, float limit) const;
  template <class Reach>
  void for_next(std::size_t state, float total, Reach&& reach) const;
  /// Halves the rows until the cheapest way ends where it began.
  [[nodiscard]] std::optional<ClosedCurve> through_column(std::span<const int> rows, float limit) const;
  [[nodiscard]] std::vector<CurveState> traced(const Totals& totals) const;

  [[nodiscard]] std::size_t index(const CurveState& state) const;
  [[nodiscard]] CurveState state_of(std::size_t index) const;
  /// What a millimetre costs; `col` is one of the unrolled side.
  [[nodiscard]] float per_mm(int row, int col, std::size_t direction) const {
    const std::size_t cell = column_[static_cast<std::size_t>(col)] + static_cast<std::size_t>(row);
    const float own = costs_.of(cell, direction);
    return dearer_.empty() ? own : own + dearer_[cell];
  }
  [[nodiscard]] float step_cost(std::size_t direction, int row, int col, int to_row, int to_col) const {
    return half_step_mm_[direction] * (per_mm(row, col, direction) + per_mm(to_row, to_col, direction));
  }

  const CurveCosts& costs_;
  std::span<const float> dearer_;
  CurveConfig config_;
  int begin_col_{0};
  int pad_cols_{0};
  int unrolled_cols_{0};
  std::vector<std::size_t> column_;  ///< of the unrolled side: its first cell
  PooledVector<float> to_end_;
  std::array<float, k_directions> half_step_mm_;
  std::array<std::array<float, 5>, k_directions> bend_;  ///< by direction and turn -2 to 2
};

}  // namespace biteline::bite_line
