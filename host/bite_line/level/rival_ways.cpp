// SPDX-License-Identifier: MIT
#include "host/bite_line/level/rival_ways.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host/bite_line/layers/layers.hpp"
#include "host/bite_line/level/branches.hpp"

namespace biteline::bite_line {

namespace {

constexpr int k_off_way = -1;

double apart_mm(const Cell& a, const Cell& b) {
  return Patch::k_cell_mm * std::hypot(a.row - b.row, a.col - b.col);
}

/// Squared, in cells.
int apart2(const Cell& a, const Cell& b) {
  return (a.row - b.row) * (a.row - b.row) + (a.col - b.col) * (a.col - b.col);
}

/// Another way between two cells of the way.
struct RivalWay {
  std::size_t first, last;
  double margin;  ///< as find_layers() has it
  double off_mm;  ///< how far it leads away
  bool above;     ///< on the upper's side
};

class RivalWays {
 public:
  RivalWays(const Patch& patch, const StepCosts& costs, const Way& way, const RivalWaysConfig& config)
      : patch_{patch},
        way_{way},
        config_{config},
        ahead_{cheapest_ways(patch, costs, way.cells.front(), Towards::Others)},
        back_{cheapest_ways(patch, costs, way.cells.back(), Towards::Root)},
        on_way_(patch.size(), k_off_way),
        taken_(patch.size(), 0) {
    for (std::size_t i = 0; i < way.cells.size(); ++i) {
      on_way_[at(way.cells[i])] = static_cast<int>(i);
      take(way.cells[i]);
    }
    for (std::size_t cell = 0; cell < patch.size(); ++cell) {
      const bool shows = std::ranges::any_of(
          costs, [&](const std::vector<float>& of_step) { return of_step[cell] < config.shows_cost; });
      if (shows && taken_[cell] == 0) open_.push_back(cell);
    }
    std::ranges::sort(open_, {}, [&](std::size_t cell) { return through(cell); });
  }

  /// Gives each rival to `hear`.
  template <class Hear>
  void tell(Hear&& hear) {
    int looked_at = 0;
    for (const std::size_t cell : open_) {
      if (taken_[cell] != 0) continue;
      if (++looked_at > config_.most) break;
      const RivalWay rival = rival_through(
          {.row = static_cast<int>(cell) % patch_.rows, .col = static_cast<int>(cell) / patch_.rows});
      if (rival.first < rival.last) hear(rival);
    }
  }

 private:
  [[nodiscard]] std::size_t at(const Cell& cell) const { return patch_.at(cell.row, cell.col); }
  [[nodiscard]] float through(std::size_t cell) const { return ahead_.total[cell] + back_.total[cell]; }

  /// What lies about a cell needs no look of its own.
  void take(const Cell& cell) { patch_.mark_about(cell, config_.apart_mm, taken_); }

  /// The way's cell where a tree's way from a cell meets it; what lies before that goes to `apart`.
  std::size_t meets(const WayTree& tree, Towards towards, const Cell& from, std::vector<Cell>& apart) const {
    for (const Cell& cell : cells_to_root(patch_, tree, towards, from)) {
      if (on_way_[at(cell)] != k_off_way) return static_cast<std::size_t>(on_way_[at(cell)]);
      apart.push_back(cell);
    }
    return 0;
  }

  RivalWay rival_through(const Cell& cell) {
    const LayersConfig as{};
    std::vector<Cell> apart;
    RivalWay rival{.first = meets(ahead_, Towards::Others, cell, apart),
                   .last = meets(back_, Towards::Root, cell, apart),
                   .margin = 0,
                   .off_mm = 0,
                   .above = false};
    for (const Cell& of : apart) take(of);
    double length_mm = 0;
    for (std::size_t i = rival.first; i < rival.last; ++i)
      length_mm += apart_mm(way_.cells[i], way_.cells[i + 1]);
    const double worse = static_cast<double>(through(at(cell))) - way_.cost;
    rival.margin = (worse + as.kink) / (length_mm + as.margin_cols);
    for (const Cell& of : apart) set_farthest(of, rival);
    return rival;
  }

  void set_farthest(const Cell& of, RivalWay& rival) const {
    constexpr std::size_t k_lever = 3;
    std::size_t nearest = rival.first;
    for (std::size_t i = rival.first; i <= rival.last; ++i)
      if (apart2(of, way_.cells[i]) < apart2(of, way_.cells[nearest])) nearest = i;
    const Cell& here = way_.cells[nearest];
    if (apart_mm(of, here) <= rival.off_mm) return;
    rival.off_mm = apart_mm(of, here);
    const Cell& before = way_.cells[nearest - std::min(nearest, k_lever)];
    const Cell& behind = way_.cells[std::min(nearest + k_lever, way_.cells.size() - 1)];
    rival.above =
        (behind.col - before.col) * (of.row - here.row) > (behind.row - before.row) * (of.col - here.col);
  }

  const Patch& patch_;
  const Way& way_;
  const RivalWaysConfig& config_;
  WayTree ahead_, back_;
  std::vector<int> on_way_;          ///< per cell: the index on the way, or k_off_way
  std::vector<std::uint8_t> taken_;  ///< per cell: on the way or on a rival that was looked at
  std::vector<std::size_t> open_;    ///< cells that show a crease, the cheapest way through them first
};

void doubt_stretch(std::size_t from, std::size_t to, double off_mm, WayDoubt& doubt) {
  const float unsure = LayersConfig{}.changed_hold;
  for (std::size_t i = from; i < to; ++i) {
    doubt.hold[i] = unsure;
    doubt.other_mm[i] = std::max(doubt.other_mm[i], static_cast<float>(off_mm));
  }
}

void doubt_unseen(const Patch& patch, const Way& way, double most_mm, WayDoubt& doubt) {
  double length_mm = 0;
  std::size_t first = 0;
  for (std::size_t i = 1; i < way.cells.size(); ++i) {
    if (patch.seen[patch.at(way.cells[i].row, way.cells[i].col)] == 0) {
      length_mm += apart_mm(way.cells[i - 1], way.cells[i]);
      continue;
    }
    if (length_mm > most_mm) doubt_stretch(first, i, length_mm / 2, doubt);
    length_mm = 0;
    first = i;
  }
}

/// Whether a plain crease that runs nearly alike lies on the upper's side of a cell.
bool plain_above(const Patch& patch, const StepCosts& costs, const Cell& cell, std::size_t step) {
  constexpr float k_plain_cost = 0.15F;
  constexpr double k_from_mm = 2.5, k_to_mm = 35.0;
  const GridStep along = k_grid_steps[step];
  const double cells = 1 / (Patch::k_cell_mm * std::hypot(along.cols, along.rows));
  for (double d = k_from_mm; d <= k_to_mm; d += Patch::k_cell_mm) {
    const int col = cell.col - static_cast<int>(std::lround(along.rows * cells * d));
    const int row = cell.row + static_cast<int>(std::lround(along.cols * cells * d));
    if (col < 0 || col >= patch.cols || row < 0 || row >= patch.rows) return false;
    for (const std::size_t k : {step + costs.size() - 1, step, step + 1})
      if (costs[k % costs.size()][patch.at(row, col)] <= k_plain_cost) return true;
  }
  return false;
}

/// Soles have many creases and uppers few: a way that leaves a plain one above it all along is another's.
/// What it costs there is EvidenceConfig::above_ratio.
void doubt_left_above(const Patch& patch, const StepCosts& costs, const Way& way,
                      const RivalWaysConfig& config, WayDoubt& doubt) {
  constexpr double k_share = 0.8;
  const double least_cost = 0.9 * EvidenceConfig{}.above_ratio;
  std::vector<double> length_mm{0}, cost{0}, above_mm{0};
  for (std::size_t i = 1; i < way.cells.size(); ++i) {
    const Cell& to = way.cells[i];
    const std::size_t step = step_between(way.cells[i - 1], to);
    const double step_mm = apart_mm(way.cells[i - 1], to);
    length_mm.push_back(length_mm.back() + step_mm);
    cost.push_back(cost.back() + step_mm * static_cast<double>(costs[step][patch.at(to.row, to.col)]));
    above_mm.push_back(above_mm.back() + (plain_above(patch, costs, to, step) ? step_mm : 0));
  }
  for (std::size_t i = 0, j = 0; i < way.cells.size(); ++i) {
    while (j < way.cells.size() && length_mm[j] - length_mm[i] < config.left_above_mm) ++j;
    if (j == way.cells.size()) break;
    const double over_mm = length_mm[j] - length_mm[i];
    if (above_mm[j] - above_mm[i] >= k_share * over_mm && cost[j] - cost[i] >= least_cost * over_mm)
      doubt_stretch(i, j + 1, config.far_mm, doubt);
  }
}

/// Cells from `begin` up to `end`.
struct Stretch {
  std::size_t begin, end;
};

std::vector<Stretch> unsure_stretches(const std::vector<float>& hold) {
  std::vector<Stretch> unsure;
  for (std::size_t i = 0; i < hold.size(); ++i) {
    if (hold[i] == 1) continue;
    if (!unsure.empty() && unsure.back().end == i)
      unsure.back().end = i + 1;
    else
      unsure.push_back({i, i + 1});
  }
  return unsure;
}

void doubt_between(double off_mm, WayDoubt& doubt) {
  const std::vector<Stretch> unsure = unsure_stretches(doubt.hold);
  if (unsure.size() < 2) return;
  // The way is closed: what lies before the first one goes on behind the last one.
  std::size_t longest = unsure.front().begin + doubt.hold.size() - unsure.back().end;
  std::size_t kept = 0;
  for (std::size_t k = 1; k < unsure.size(); ++k) {
    const std::size_t between = unsure[k].begin - unsure[k - 1].end;
    if (between <= longest) continue;
    longest = between;
    kept = k;
  }
  for (std::size_t k = 1; k < unsure.size(); ++k)
    if (k != kept) doubt_stretch(unsure[k - 1].end, unsure[k].begin, off_mm, doubt);
  if (kept == 0) return;
  doubt_stretch(0, unsure.front().begin, off_mm, doubt);
  doubt_stretch(unsure.back().end, doubt.hold.size(), off_mm, doubt);
}

}  // namespace

WayDoubt doubt_way(const Patch& patch, const StepCosts& costs, const StepCosts& bare_costs, const Way& way,
                   const RivalWaysConfig& config) {
  WayDoubt doubt{.hold = std::vector<float>(way.cells.size(), 1.0F),
                 .other_mm = std::vector<float>(way.cells.size(), 0.0F)};
  RivalWays{patch, costs, way, config}.tell([&](const RivalWay& rival) {
    const bool far_above = rival.above && rival.off_mm >= config.far_mm;
    if (rival.margin < (far_above ? config.least_far_margin : LayersConfig{}.margin))
      doubt_stretch(rival.first, rival.last + 1, rival.off_mm, doubt);
  });
  const Branches found = branches(patch, bare_costs, places_of(patch, way), {});
  for (const std::vector<std::size_t>* at : {&found.onto, &found.off})
    for (const std::size_t i : *at) doubt_stretch(i, i + 1, config.far_mm, doubt);
  doubt_left_above(patch, costs, way, config, doubt);
  doubt_unseen(patch, way, config.most_unseen_mm, doubt);
  doubt_between(config.apart_mm, doubt);
  return doubt;
}

bool leaves_plainer(const Patch& patch, const StepCosts& bare_costs, const Way& way,
                    const RivalWaysConfig& config) {
  const Way bare{.cells = way.cells, .cost = cost_of(patch, bare_costs, way.cells)};
  bool leaves = false;
  RivalWays{patch, bare_costs, bare, config}.tell(
      [&](const RivalWay& rival) { leaves = leaves || rival.margin < -LayersConfig{}.margin; });
  return leaves;
}

}  // namespace biteline::bite_line
