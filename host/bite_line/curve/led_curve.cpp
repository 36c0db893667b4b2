// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/led_curve.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace biteline::bite_line {

namespace {

constexpr float k_out_of_reach = std::numeric_limits<float>::max();
constexpr std::uint32_t k_none = std::numeric_limits<std::uint32_t>::max();

/// The part of the side that a led curve may use.
class Window {
 public:
  Window(const Raster& raster, std::span<const CurveLead> leads) : raster_{raster} {
    constexpr double k_beside_mm = 15;
    const auto [first, last] =
        std::ranges::minmax(leads, {}, [](const CurveLead& lead) { return lead.place.x(); });
    first_col_ = static_cast<int>(std::floor(raster.col_of(first.place.x() - k_beside_mm)));
    cols_ = static_cast<int>(std::ceil(raster.col_of(last.place.x() + k_beside_mm))) - first_col_ + 1;
  }

  [[nodiscard]] std::size_t states() const {
    return static_cast<std::size_t>(cols_) * static_cast<std::size_t>(raster_.rows) * k_directions;
  }
  [[nodiscard]] std::optional<std::uint32_t> index(const CurveState& at) const {
    const int col = at.col - first_col_;
    if (at.row < 0 || at.row >= raster_.rows || col < 0 || col >= cols_) return std::nullopt;
    return static_cast<std::uint32_t>(raster_.at(at.row, col) * k_directions + at.direction);
  }
  [[nodiscard]] CurveState state(std::uint32_t index) const {
    const std::size_t place = index / k_directions;
    const auto rows = static_cast<std::size_t>(raster_.rows);
    return {.row = static_cast<int>(place % rows),
            .col = static_cast<int>(place / rows) + first_col_,
            .direction = index % k_directions};
  }
  /// States whose places a lead allows.
  [[nodiscard]] std::vector<std::uint32_t> states_at(const CurveLead& lead) const {
    const int reach = static_cast<int>(lead.reach_mm / Raster::k_cell_mm) + 1;
    const int row = static_cast<int>(std::lround(raster_.row_of(lead.place.y())));
    const int col = static_cast<int>(std::lround(raster_.col_of(lead.place.x())));
    std::vector<std::uint32_t> states;
    for (int c = col - reach; c <= col + reach; ++c) {
      for (int r = row - reach; r <= row + reach; ++r) {
        if ((raster_.place(r, c) - lead.place).norm() > lead.reach_mm) continue;
        for (std::size_t k = 0; k < k_directions; ++k)
          if (const std::optional<std::uint32_t> at = index({r, c, k})) states.push_back(*at);
      }
    }
    return states;
  }

 private:
  const Raster& raster_;
  int first_col_{0}, cols_{0};
};

/// What the cheapest ways from one lead to the next cost, per state, and where they come from.
struct Leg {
  std::vector<float> total;
  std::vector<std::uint32_t> from;
};

class LedSearch {
 public:
  LedSearch(const Raster& raster, const CurveCosts& costs, std::span<const CurveLead> leads,
            const CurveConfig& config)
      : raster_{raster}, costs_{costs}, leads_{leads}, config_{config}, window_{raster, leads} {}

  [[nodiscard]] std::optional<std::vector<Vec2>> run() const {
    std::vector<Leg> legs;
    std::vector<std::uint32_t> ends = window_.states_at(leads_.front());
    std::vector<float> begins(ends.size(), 0.0F);
    for (std::size_t i = 1; i < leads_.size(); ++i) {
      const std::vector<std::uint32_t> next = window_.states_at(leads_[i]);
      legs.push_back(leg(ends, begins, next));
      begins.clear();
      ends.clear();
      for (const std::uint32_t at : next) {
        if (legs.back().total[at] == k_out_of_reach) continue;
        ends.push_back(at);
        begins.push_back(legs.back().total[at]);
      }
      if (ends.empty()) return std::nullopt;
    }
    const auto cheapest = std::ranges::min_element(begins) - begins.begin();
    return traced(legs, ends[static_cast<std::size_t>(cheapest)]);
  }

 private:
  [[nodiscard]] Leg leg(std::span<const std::uint32_t> from, std::span<const float> begins,
                        std::span<const std::uint32_t> to) const {
    // Of two places that one lead allows, the second costs no more than to go there from the first.
    constexpr float k_beyond = 20;
    Leg leg{.total = std::vector<float>(window_.states(), k_out_of_reach),
            .from = std::vector<std::uint32_t>(window_.states(), k_none)};
    std::vector<std::uint8_t> is_end(window_.states(), 0);
    for (const std::uint32_t at : to) is_end[at] = 1;
    using Next = std::pair<float, std::uint32_t>;
    std::priority_queue<Next, std::vector<Next>, std::greater<>> open;
    for (std::size_t i = 0; i < from.size(); ++i) {
      leg.total[from[i]] = begins[i];
      open.emplace(begins[i], from[i]);
    }
    float most = k_out_of_reach;
    while (!open.empty()) {
      const auto [total, here] = open.top();
      open.pop();
      if (total > leg.total[here]) continue;
      if (total > most) break;
      if (is_end[here] != 0 && most == k_out_of_reach) most = total + k_beyond;
      step_on(window_.state(here), [&](const CurveState& next, float cost) {
        const std::optional<std::uint32_t> there = window_.index(next);
        if (!there || total + cost >= leg.total[*there]) return;
        leg.total[*there] = total + cost;
        leg.from[*there] = here;
        open.emplace(total + cost, *there);
      });
    }
    return leg;
  }

  template <class Reach>
  void step_on(const CurveState& here, Reach&& reach) const {
    const CellStep step = k_cell_steps[here.direction];
    CurveState next{.row = here.row + step.rows, .col = here.col + step.cols, .direction = here.direction};
    if (next.row < 0 || next.row >= raster_.rows) return;
    const double length_mm = Raster::k_cell_mm * step.length();
    const auto per_mm = [&](const CurveState& at) {
      return costs_.of(costs_.at(at.row, raster_.round_col(at.col)), here.direction);
    };
    const float cost = static_cast<float>(0.5 * length_mm) * (per_mm(here) + per_mm(next));
    for (int turn = -k_most_turn; turn <= k_most_turn; ++turn) {
      next.direction = here.direction + static_cast<std::size_t>(turn);
      if (next.direction < k_directions) reach(next, cost + bend_cost(here.direction, turn, config_.bend_mm));
    }
  }

  [[nodiscard]] std::vector<Vec2> traced(std::span<const Leg> legs, std::uint32_t end) const {
    std::vector<Vec2> places;
    const auto put = [&](std::uint32_t at) {
      const CurveState state = window_.state(at);
      places.push_back(raster_.place(state.row, state.col));
    };
    put(end);
    std::uint32_t at = end;
    for (std::size_t i = legs.size(); i-- > 0;) {
      for (std::uint32_t from = legs[i].from[at]; from != k_none; from = legs[i].from[at]) {
        at = from;
        put(at);
      }
    }
    std::ranges::reverse(places);
    return places;
  }

  const Raster& raster_;
  const CurveCosts& costs_;
  std::span<const CurveLead> leads_;
  const CurveConfig& config_;
  Window window_;
};

}  // namespace

std::vector<CurveLead> in_order(std::span<const CurveLead> leads) {
  if (leads.size() < 3) return {leads.begin(), leads.end()};
  std::vector<CurveLead> ordered{leads.front(), leads.back()};
  const auto apart = [](const CurveLead& a, const CurveLead& b) { return (a.place - b.place).norm(); };
  for (const CurveLead& lead : leads.subspan(1, leads.size() - 2)) {
    std::size_t best = 1;
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 1; i < ordered.size(); ++i) {
      const double longer =
          apart(ordered[i - 1], lead) + apart(lead, ordered[i]) - apart(ordered[i - 1], ordered[i]);
      if (longer >= least) continue;
      least = longer;
      best = i;
    }
    ordered.insert(ordered.begin() + static_cast<std::ptrdiff_t>(best), lead);
  }
  return ordered;
}

std::optional<std::vector<Vec2>> led_curve(const Raster& raster, const CurveCosts& costs,
                                           std::span<const CurveLead> leads, const CurveConfig& config) {
  if (leads.size() < 2) return std::nullopt;
  return LedSearch{raster, costs, leads, config}.run();
}

}  // namespace biteline::bite_line
