// SPDX-License-Identifier: MIT
#include "host/fleet/odd_cell.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace biteline::fleet {
namespace {

constexpr double k_normal_mad = 1.4826;  // spread of a normal distribution for its median absolute deviation
constexpr double k_normal_95 = 1.96;
constexpr std::size_t k_features = 3;
using Features = std::array<double, k_features>;

/// Mean, cosine and sine of the distances round the line, in mm.
Features features_of(const memory::Places& places) {
  Features sums{};
  const auto count = static_cast<double>(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / count;
    const auto place = static_cast<double>(places.at(i));
    sums[0] += place / count;
    sums[1] += 2 * place * std::cos(angle) / count;
    sums[2] += 2 * place * std::sin(angle) / count;
  }
  return sums;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

struct Level {
  double median_mm{0};
  double spread_mm{0};
};

Level level_of(const std::vector<double>& values) {
  Level level{.median_mm = median(values), .spread_mm = 0};
  std::vector<double> away;
  for (const double value : values) away.push_back(std::abs(value - level.median_mm));
  level.spread_mm = std::max(k_least_spread_mm, k_normal_mad * median(std::move(away)));
  return level;
}

/// Where a sum that passed the limit began to rise for the last time; nothing: none passed it.
std::optional<std::size_t> change_in(std::span<const double> values, const Level& level, double sign) {
  const double slack = std::max(k_slack, k_slack_mm / level.spread_mm);
  double sum = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum = std::max(0.0, sum + sign * (values[i] - level.median_mm) / level.spread_mm - slack);
    if (sum > k_limit) return begin;
    if (sum == 0) begin = i + 1;
  }
  return std::nullopt;
}

struct CellShoes {
  std::vector<std::string> scans;
  std::array<std::vector<double>, k_features> values;
};

}  // namespace

const char* to_text(Difference difference) {
  constexpr std::array k_words{"wider or narrower all round", "shifted along its first axis",
                               "shifted along its second axis"};
  return k_words.at(static_cast<std::size_t>(difference));
}

std::vector<OddCell> odd_cells(std::span<const PlacedShoe> shoes) {
  std::map<std::string, CellShoes> cells;
  for (const PlacedShoe& shoe : shoes) {
    CellShoes& cell = cells[shoe.cell];
    cell.scans.push_back(shoe.scan);
    const Features features = features_of(shoe.places);
    for (std::size_t f = 0; f < k_features; ++f) cell.values.at(f).push_back(features.at(f));
  }
  std::vector<OddCell> odd;
  if (cells.size() < k_least_other_cells + 1) return odd;
  for (const auto& [name, cell] : cells) {
    std::optional<OddCell> surest;
    for (std::size_t f = 0; f < k_features; ++f) {
      std::vector<double> others;
      for (const auto& [other, its] : cells) {
        if (other != name) others.insert(others.end(), its.values.at(f).begin(), its.values.at(f).end());
      }
      if (others.size() < k_least_shoes_of_others) continue;
      const Level level = level_of(others);
      const std::vector<double>& values = cell.values.at(f);
      for (const double sign : {1.0, -1.0}) {
        const std::optional<std::size_t> begin = change_in(values, level, sign);
        if (!begin) continue;
        const auto count = static_cast<double>(values.size() - *begin);
        OddCell found{.cell = name,
                      .difference = static_cast<Difference>(f),
                      .mm = 0,
                      .u95_mm = k_normal_95 * level.spread_mm / std::sqrt(count),
                      .shoes = static_cast<int>(count),
                      .since = cell.scans.at(*begin)};
        for (std::size_t i = *begin; i < values.size(); ++i)
          found.mm += (values[i] - level.median_mm) / count;
        const auto sureness = [](const OddCell& one) { return std::abs(one.mm) / one.u95_mm; };
        if (!surest || sureness(found) > sureness(*surest)) surest = found;
      }
    }
    if (surest) odd.push_back(*surest);
  }
  return odd;
}

}  // namespace biteline::fleet
