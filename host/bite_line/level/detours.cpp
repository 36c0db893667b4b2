// SPDX-License-Identifier: MIT
#include "host/bite_line/level/detours.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "host/bite_line/level/branches.hpp"
#include "host/bite_line/level/cheapest_way.hpp"
#include "host/bite_line/level/course_gaps.hpp"
#include "host/bite_line/level/patch.hpp"
#include "host/bite_line/level/rival_ways.hpp"
#include "host/bite_line/level/step_costs.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

constexpr double k_beside_mm = 10.0;  // of a gap's ends: on the crease

/// Cells about a way, but for its ends.
std::vector<std::uint8_t> about(const Patch& patch, const Way& way, double reach_mm) {
  constexpr std::size_t k_ends = 24;
  std::vector<std::uint8_t> cells(patch.size(), 0);
  for (std::size_t i = k_ends; i + k_ends < way.cells.size(); ++i)
    patch.mark_about(way.cells[i], reach_mm, cells);
  return cells;
}

/// Whether a gap with its ends beside it reaches into what a detour covers.
bool overlap(const CourseGap& gap, const Detour& detour, const SideGrid& grid) {
  const double turn_mm = grid.cols * grid.col_mm;
  const double from_mm = gap.first * grid.col_mm - k_beside_mm;
  const double length_mm = gap.cols * grid.col_mm + 2 * k_beside_mm;
  const double other_mm = detour.places.back().x() - detour.places.front().x();
  const auto ahead = [&](double mm) { return mm - turn_mm * std::floor(mm / turn_mm); };
  return ahead(detour.places.front().x() - from_mm) < length_mm ||
         ahead(from_mm - detour.places.front().x()) < other_mm;
}

CourseGap widened(const CourseGap& gap, const SideGrid& grid, double beside_mm) {
  const int beside = static_cast<int>(std::lround(beside_mm / grid.col_mm));
  return {.first = gap.first - beside, .cols = gap.cols + 2 * beside, .changes = gap.changes};
}

class GapLook {
 public:
  /// `gap_mm`: of the gap itself, where the look is wider.
  GapLook(const Side& side, const CourseOverS& course, const CourseGap& gap, double gap_mm,
          const DetourConfig& config)
      : course_{course},
        gap_{gap},
        own_mm_{gap_mm + 2 * k_beside_mm},
        config_{config},
        length_mm_{gap.cols * side.field.grid.col_mm},
        from_mm_{gap.first * side.field.grid.col_mm - k_beside_mm},
        to_mm_{from_mm_ + length_mm_ + 2 * k_beside_mm},
        patch_{Patch::of(side, window(), k_sigma_mm)},
        looks_{look_at_steps(patch_, {})},
        costs_{step_costs(patch_, looks_)} {}

  /// None where the course is as good as any way.
  [[nodiscard]] std::optional<Detour> detour() const {
    const Cell from = patch_.cell({from_mm_, course_.z_mm(from_mm_)});
    const Cell to = patch_.cell({to_mm_, course_.z_mm(to_mm_)});
    const Way way = cheapest_way(patch_, costs_, from, to);
    Detour detour;
    double unseen_mm = 0, away_mm = 0, bare_mm = 0, longest_bare_mm = 0;
    for (std::size_t i = 0; i < way.cells.size(); ++i) {
      const Cell& at = way.cells[i];
      detour.places.push_back(patch_.place(at.row, at.col));
      const double off = course_.off_mm(detour.places.back());
      detour.off_mm = std::max(detour.off_mm, off);
      if (i == 0) continue;
      const double step_mm = (detour.places[i] - detour.places[i - 1]).norm();
      const bool seen = patch_.seen[patch_.at(at.row, at.col)] != 0;
      if (!seen) unseen_mm += step_mm;
      bare_mm = seen && is_bare(way.cells[i - 1], at) ? bare_mm + step_mm : 0;
      longest_bare_mm = std::max(longest_bare_mm, bare_mm);
      if (off < k_on_course_mm) continue;
      away_mm += step_mm;
      if (detour.last == 0) detour.first = i;
      detour.last = i;
    }
    const bool same = detour.off_mm < config_.apart_mm;
    if (same && !gap_.changes) return std::nullopt;
    detour.hidden = unseen_mm > config_.most_unseen_mm;
    const double seen_cost =
        (way.cost - (detour.hidden ? k_unseen_cost * unseen_mm : 0)) / (to_mm_ - from_mm_);
    const bool dear = seen_cost > config_.most_far_cost;
    // Near by a dear way is the course's own, on a crease that hardly shows.
    if (dear && (detour.off_mm < config_.far_mm || seen_cost > config_.most_told_cost)) return std::nullopt;
    if (detour.hidden && detour.off_mm < config_.far_mm) return std::nullopt;
    const double straight = course_.cost(patch_, costs_, from_mm_, to_mm_);
    if (!(margin_of(straight - way.cost, away_mm) > LayersConfig{}.margin)) return std::nullopt;
    detour.sure = !dear && !detour.hidden && longest_bare_mm < config_.most_bare_mm &&
                  is_sure(way, detour.off_mm, from, to);
    // A way along the course that is not sure says nothing that the course does not.
    if (same && !detour.sure) return std::nullopt;
    return detour;
  }

 private:
  static constexpr double k_sigma_mm = 0.7;
  static constexpr double k_on_course_mm = 1.0;  // a way in cells is not smooth

  [[nodiscard]] Window window() const {
    constexpr double k_margin_mm = 12.0, k_below_mm = 15.0, k_above_mm = 32.0;
    double low = course_.z_mm(from_mm_), high = low;
    for (double s = from_mm_; s <= to_mm_; s += Patch::k_cell_mm) {
      low = std::min(low, course_.z_mm(s));
      high = std::max(high, course_.z_mm(s));
    }
    return {.s_mm = from_mm_ - k_margin_mm,
            .length_mm = to_mm_ - from_mm_ + 2 * k_margin_mm,
            .z_mm = low - k_below_mm,
            .height_mm = high - low + k_below_mm + k_above_mm};
  }

  /// Whether a step shows hardly a crease.
  [[nodiscard]] bool is_bare(const Cell& from, const Cell& to) const {
    constexpr float k_bare_cost = 0.8F;
    return costs_[step_between(from, to)][patch_.at(to.row, to.col)] > k_bare_cost;
  }

  /// As find_layers() has it for a rival.
  [[nodiscard]] static double margin_of(double worse, double over_mm) {
    const LayersConfig as{};
    return (worse + as.kink) / (over_mm + as.margin_cols);
  }

  [[nodiscard]] bool is_sure(const Way& way, double off_mm, Cell from, Cell to) const {
    const bool far = off_mm >= config_.far_mm;
    if (way.cost / own_mm_ > (far ? config_.most_far_cost : config_.most_near_cost)) return false;
    const Way next = cheapest_way(patch_, costs_, from, to, about(patch_, way, config_.apart_mm));
    const double least_margin = far ? config_.least_far_margin : config_.least_near_margin;
    if (margin_of(next.cost - way.cost, length_mm_) <= least_margin) return false;
    const StepCosts bare_costs = step_costs(patch_, looks_, 0);
    return !leaves_plainer(patch_, bare_costs, way, {}) &&
           !branches(patch_, bare_costs, places_of(patch_, way), {}).lie_on_another();
  }

  const CourseOverS& course_;
  const CourseGap& gap_;
  double own_mm_;  ///< a sure way is paid for over this length alone
  const DetourConfig& config_;
  double length_mm_, from_mm_, to_mm_;
  Patch patch_;
  StepLooks looks_;
  StepCosts costs_;
};

}  // namespace

std::vector<Detour> find_detours(const Side& side, const Layers& layers, const DetourConfig& config) {
  const SideGrid& grid = side.field.grid;
  const CourseOverS course{grid, layers.line};
  std::vector<Detour> detours;
  const std::vector<CourseGap> gaps = gaps_of(grid, layers, {.least_mm = config.least_gap_mm});
  const auto look = [&](const CourseGap& gap, const CourseGap& wide) {
    return GapLook{side, course, wide, gap.cols * grid.col_mm, config}.detour();
  };
  const auto is_free = [&](const CourseGap& gap) {
    return std::ranges::none_of(detours, [&](const Detour& other) { return overlap(gap, other, grid); });
  };
  // What leaves its crease for another one may come back far away.
  for (const CourseGap& gap : gaps) {
    const bool leaves = gap.changes || course.jump_mm(gap) != 0;
    // Where the look would go more than half round, it goes less far.
    const double room_mm = 0.5 * (0.5 * grid.cols - gap.cols) * grid.col_mm;
    const CourseGap wide = widened(gap, grid, std::min(config.beside_mm, room_mm));
    if (!leaves || room_mm < 0 || !is_free(wide)) continue;
    std::optional<Detour> detour = look(gap, wide);
    if (detour && (detour->sure || detour->off_mm >= config.far_mm)) detours.push_back(std::move(*detour));
  }
  // A faded crease is the line's own, most of all; a sure way far off says that it is not.
  const auto take_sure_and_far = [&](const CourseGap& gap, const DetourConfig& by) {
    if (gap.cols * grid.col_mm > config.longest_gap_mm || !is_free(gap)) return;
    std::optional<Detour> detour = GapLook{side, course, gap, gap.cols * grid.col_mm, by}.detour();
    if (detour && detour->sure && detour->off_mm >= config.far_mm) detours.push_back(std::move(*detour));
  };
  GapConfig weak{.least_mm = config.least_gap_mm,
                 .least_turn_rad = config.weak_ratio * layers.line.median_turn_rad};
  const std::vector<CourseGap> weak_gaps = gaps_of(grid, layers, weak);
  // A badge on a guard shows a piece of a crease below its edge, between two such gaps.
  weak.island_mm = config.longest_island_mm;
  DetourConfig joining = config;
  joining.most_far_cost = config.most_joined_cost;
  for (const CourseGap& gap : gaps_of(grid, layers, weak)) {
    const auto parts = std::ranges::count_if(weak_gaps, [&](const CourseGap& part) {
      return part.first >= gap.first && part.first + part.cols <= gap.first + gap.cols;
    });
    if (parts >= 2) take_sure_and_far(gap, joining);
  }
  for (const CourseGap& gap : weak_gaps) take_sure_and_far(gap, config);
  for (const CourseGap& gap : gaps) {
    if (gap.cols * grid.col_mm > config.longest_gap_mm || !is_free(gap)) continue;
    if (std::optional<Detour> detour = look(gap, gap)) detours.push_back(std::move(*detour));
  }
  // The side is levelled once, and read anew: what is unsure of a gap would be forgotten there.
  if (!std::ranges::all_of(detours, &Detour::sure)) {
    for (Detour& detour : detours) detour.sure = false;
  }
  return detours;
}

void doubt_detours(const SideGrid& grid, std::span<const Detour> detours, Layers& layers) {
  constexpr float k_hidden_hold = 0.94F;  // below 0.95, from where on U95 does not ask for the other way
  for (const Detour& detour : detours) {
    if (detour.sure) continue;
    const float unsure = detour.hidden ? k_hidden_hold : LayersConfig{}.changed_hold;
    for (double s = detour.places[detour.first].x(); s <= detour.places[detour.last].x(); s += grid.col_mm) {
      const auto col = geometry::round_index(0, static_cast<std::ptrdiff_t>(std::floor(s / grid.col_mm)),
                                             static_cast<std::size_t>(grid.cols));
      layers.hold[col] = std::min(layers.hold[col], unsure);
      layers.other_mm[col] = std::max(layers.other_mm[col], static_cast<float>(detour.off_mm));
    }
  }
}

std::vector<Vec2> guide_of(const Side& side, const Crease& line, std::span<const Detour> detours) {
  const SideGrid& grid = side.field.grid;
  const double turn_mm = side.outline.length_mm();
  const CourseOverS course{grid, line};
  const auto detour_at = [&](double s) -> const Detour* {
    for (const Detour& detour : detours) {
      const double after = s - detour.places.front().x();
      const double way = after - turn_mm * std::floor(after / turn_mm);
      if (detour.sure && way < detour.places.back().x() - detour.places.front().x()) return &detour;
    }
    return nullptr;
  };
  std::vector<Vec2> guide;
  if (std::ranges::none_of(detours, &Detour::sure)) return guide;
  double begin_mm = 0.5 * grid.col_mm;
  while (begin_mm < turn_mm && detour_at(begin_mm) != nullptr) begin_mm += grid.col_mm;
  const Detour* last = nullptr;
  for (int k = 0; k < grid.cols; ++k) {
    const double s = begin_mm + k * grid.col_mm;
    const Detour* detour = detour_at(s);
    if (detour == nullptr) {
      guide.emplace_back(s, course.z_mm(s));
    } else if (detour != last) {
      const double rounds = std::round((s - detour->places.front().x()) / turn_mm);
      for (const Vec2& place : detour->places) guide.emplace_back(place.x() + rounds * turn_mm, place.y());
    }
    last = detour;
  }
  return guide;
}

}  // namespace biteline::bite_line
