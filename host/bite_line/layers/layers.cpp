// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/layers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

#include "host/geometry/logistic.hpp"

namespace biteline::bite_line {

namespace {

constexpr double k_mean_mm = 8.5;            // along the line, of its place
constexpr std::size_t k_shortest_told = 15;  // columns: a shorter rival is told by the points' confidence

/// A weak crease on a surface that lies nearly flat: a little in height is much along the surface.  On drawn
/// and scanned shoes a crease of 8 degrees where the surface goes in by 3 mm for each one up is off by up to
/// three.  With 0.7 all that is off by 2 mm on a canvas shoe's toe counts below 0.5.  Nothing where the
/// surface was not seen.
std::optional<float> sharpness(const SideField& field, const Crease& line, int col) {
  constexpr double k_plain_rad = 0.1;
  constexpr double k_least_rad = 0.02;
  constexpr int k_reach_rows = 4;
  const SideGrid& grid = field.grid;
  const int row = static_cast<int>(std::lround(line.row[static_cast<std::size_t>(col)]));
  if (row < k_reach_rows || row + k_reach_rows >= grid.rows) return std::nullopt;
  const std::size_t low = grid.at(row - k_reach_rows, col);
  const std::size_t high = grid.at(row + k_reach_rows, col);
  if (field.seen[low] == 0 || field.seen[high] == 0) return std::nullopt;
  const double slope =
      static_cast<double>(field.o_mm[high] - field.o_mm[low]) / (2 * k_reach_rows * grid.row_mm);
  const double turn =
      std::max(static_cast<double>(line.turn_rad[static_cast<std::size_t>(col)]), k_least_rad);
  const double doubt = 0.7 * std::pow(slope * k_plain_rad / turn, 2);
  return static_cast<float>(1 / (1 + doubt));
}

/// Between two places of a column; level where the surface of one was not seen.
float apart_mm(const SideField& field, int col, int row, int other) {
  const SideGrid& grid = field.grid;
  const std::size_t a = grid.at(row, col);
  const std::size_t b = grid.at(other, col);
  const float out_mm = field.seen[a] != 0 && field.seen[b] != 0 ? field.o_mm[a] - field.o_mm[b] : 0.0F;
  return std::hypot(out_mm, static_cast<float>((row - other) * grid.row_mm));
}

std::vector<int> with_branch(const Course& course, const Branch& branch) {
  std::vector<int> row = course.row;
  for (std::size_t k = 0; k < branch.row.size(); ++k)
    row[(static_cast<std::size_t>(branch.first_col) + k) % row.size()] = branch.row[k];
  return row;
}

/// What the materials say of a course against its rivals: -1 to 1.
class MaterialVote {
 public:
  MaterialVote(const Course& course, const MaterialsOfSide& of_side) : course_{course}, of_side_{of_side} {}

  /// A part of the way round says nothing: caps, counters and bumpers have colours of their own.
  double favours(const Branch& branch) {
    if (!of_side_ || branch.row.size() != course_.row.size()) return 0;
    if (!asked_) {
      materials_ = of_side_();
      asked_ = true;
    }
    return materials_ ? materials_->favours(course_.row, with_branch(course_, branch)) : 0;
  }

 private:
  const Course& course_;
  const MaterialsOfSide& of_side_;
  std::optional<Materials> materials_;
  bool asked_{false};
};

}  // namespace

std::vector<float> sharp_along(const SideField& field, const Crease& line) {
  const SideGrid& grid = field.grid;
  // A point's place is a mean over its neighbours: all of them count.
  const int reach = static_cast<int>(std::lround(k_mean_mm / 2 / grid.col_mm));
  std::vector<float> sharp(static_cast<std::size_t>(grid.cols), 1.0F);
  // What was not seen is no sharper than what lies on its sides: a bridge leans on both.
  float last = 1;
  for (int col = 0; col < 2 * grid.cols; ++col) {
    const int at = col % grid.cols;
    const std::optional<float> seen = sharpness(field, line, at);
    last = seen.value_or(last);
    sharp[static_cast<std::size_t>(at)] = last;
  }
  last = 1;
  for (int col = 2 * grid.cols - 1; col >= 0; --col) {
    const int at = col % grid.cols;
    const std::optional<float> seen = sharpness(field, line, at);
    last = seen.value_or(last);
    float& here = sharp[static_cast<std::size_t>(at)];
    here = std::min(here, last);
  }
  std::vector<float> about;
  for (int col = 0; col < grid.cols; ++col) {
    float least = 1;
    for (int c = col - reach; c <= col + reach; ++c)
      least = std::min(least, sharp[static_cast<std::size_t>((c + grid.cols) % grid.cols)]);
    about.push_back(least);
  }
  return about;
}

FirstLook first_look(const SideField& field, const LayersConfig& config) {
  Evidence evidence = find_evidence(field, config.evidence);
  Ways ways{evidence.cost, field.grid.rows, field.grid.cols, config.course.path};
  ClosedPath best = ways.best();
  return {.evidence = std::move(evidence), .ways = std::move(ways), .best = std::move(best)};
}

Layers find_layers(const SideField& field, const FirstLook& look, const LayersConfig& config,
                   const MaterialsOfSide& materials) {
  const SideGrid& grid = field.grid;
  const Evidence& evidence = look.evidence;
  const Course course = find_course(look.ways, look.best, config.course);
  const auto margin_of = [&](const Branch& branch) {
    const bool returns = branch.over_cols < grid.cols;
    return (branch.worse + (returns ? config.kink : 0.0)) / (branch.over_cols + config.margin_cols);
  };

  Layers layers;
  layers.hold.assign(static_cast<std::size_t>(grid.cols), 1.0F);
  layers.other_mm.assign(static_cast<std::size_t>(grid.cols), 0.0F);
  struct Told {
    const Branch* branch;
    double margin, material;
  };
  std::vector<Told> told;
  MaterialVote vote{course, materials};
  for (const Branch& branch : course.branches) {
    const double margin = margin_of(branch);
    const double material = margin < config.material_most_margin ? vote.favours(branch) : 0;
    const double log_odds =
        (margin - config.margin) / config.margin_soft + config.material_log_odds * material;
    const auto hold = static_cast<float>(geometry::logistic(log_odds));
    for (std::size_t k = 0; k < branch.row.size(); ++k) {
      const std::size_t col = (static_cast<std::size_t>(branch.first_col) + k) % layers.hold.size();
      // What was not seen is bridged, and told as that.
      if (field.seen[grid.at(course.row[col], static_cast<int>(col))] == 0) continue;
      if (!(hold < layers.hold[col])) continue;
      layers.hold[col] = hold;
      layers.other_mm[col] = apart_mm(field, static_cast<int>(col), course.row[col], branch.row[k]);
    }
    if (branch.row.size() >= k_shortest_told) told.push_back({&branch, margin, material});
  }
  layers.others = other_creases(field, course.row, layer_changes(field, course.row, config.change),
                                config.change, course.branches);
  for (const OtherCrease& other : layers.others) {
    for (int k = 0; k <= other.cols; ++k) {
      const auto col = static_cast<std::size_t>((other.first_col + k) % grid.cols);
      const auto off_mm = static_cast<float>(other.off_mm);
      const bool doubted = layers.hold[col] <= config.changed_hold;
      layers.other_mm[col] = doubted ? std::max(layers.other_mm[col], off_mm) : off_mm;
      layers.hold[col] = std::min(layers.hold[col], config.changed_hold);
    }
  }
  std::stable_sort(told.begin(), told.end(),
                   [](const Told& a, const Told& b) { return a.margin < b.margin; });
  told.resize(std::min(told.size(), static_cast<std::size_t>(config.most)));

  layers.rivals.resize(told.size());
  tbb::parallel_for(std::size_t{0}, told.size() + 1, [&](std::size_t i) {
    if (i == 0) {
      layers.line = describe(field, evidence.likeness, course.row, config.crease);
      return;
    }
    const Branch& branch = *told[i - 1].branch;
    layers.rivals[i - 1] = {
        .crease = describe(field, evidence.likeness, with_branch(course, branch), config.crease),
        .first_col = branch.first_col,
        .cols = static_cast<int>(branch.row.size()),
        .above = branch.above,
        .all_round = branch.over_cols >= grid.cols,
        .margin = told[i - 1].margin,
        .material = told[i - 1].material};
  });
  layers.sharp = sharp_along(field, layers.line);
  return layers;
}

}  // namespace biteline::bite_line
