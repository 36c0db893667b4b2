// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/material.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace biteline::bite_line {

namespace {

constexpr double k_sigma_per_median = 1.4826;

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Materials::Materials(const SideGrid& grid, const MaterialConfig& config)
    : grid_{grid},
      config_{config},
      rows_{static_cast<int>(grid.rows * grid.row_mm / config.row_mm) + 1},
      cols_{std::max(1, static_cast<int>(grid.cols * grid.col_mm / config.col_mm))} {}

std::optional<Materials> Materials::of(const Shoe& shoe, const SideField& field,
                                       std::span<const RunLook> looks, const MaterialConfig& config) {
  if (looks.empty()) return std::nullopt;
  Materials materials{field.grid, config};
  materials.collect(shoe, field, looks);
  if (!materials.fit()) return std::nullopt;
  return materials;
}

void Materials::collect(const Shoe& shoe, const SideField& field, std::span<const RunLook> looks) {
  const auto height = static_cast<std::size_t>(rows_) + 1;
  below_.assign(height * static_cast<std::size_t>(cols_), Sums{});
  const auto z_low_mm = static_cast<float>(grid_.z_low_mm);
  const auto per_row = static_cast<float>(1 / config_.row_mm);
  const auto per_col = static_cast<float>(cols_ / (grid_.cols * grid_.col_mm));
  // More say nothing more: some four in each cell are left.
  constexpr std::size_t k_enough_runs = 60'000;
  const std::size_t every = field.places.size() / k_enough_runs + 1;
  for (std::size_t i = 0; i < field.places.size(); i += every) {
    const OutlinePlace& place = field.places[i];
    const float z = (place.z_mm - z_low_mm) * per_row;
    if (place.s_mm < 0 || !(z >= 0 && z < static_cast<float>(rows_))) continue;
    const RunLook& look = looks[shoe.index[i]];
    if (look.log_amplitude == RunLook::k_unknown || look.log_width == RunLook::k_unknown) continue;
    const auto col = static_cast<std::size_t>(std::min(cols_ - 1, static_cast<int>(place.s_mm * per_col)));
    Sums& cell = below_[col * height + static_cast<std::size_t>(z) + 1];
    cell.runs += 1;
    cell.value[k_amplitude] += look.log_amplitude;
    cell.value[k_width] += look.log_width;
  }
  const int reach = std::max(1, static_cast<int>(std::lround(config_.row_mm / grid_.row_mm)));
  tbb::parallel_for(0, cols_, [&](int col) {
    const int field_col = std::min(grid_.cols - 1, static_cast<int>((col + 0.5) * grid_.cols / cols_));
    Sums* column = below_.data() + static_cast<std::size_t>(col) * height;
    for (int row = 0; row < rows_; ++row) {
      Sums& cell = column[row + 1];
      const int middle = static_cast<int>((row + 0.5) * config_.row_mm / grid_.row_mm);
      const int low = middle - reach, high = middle + reach;
      const bool inside = low >= 0 && high < grid_.rows;
      const std::size_t a = inside ? grid_.at(low, field_col) : 0, b = inside ? grid_.at(high, field_col) : 0;
      if (cell.runs > 0 && inside && field.seen[a] != 0 && field.seen[b] != 0) {
        const float slope = (field.o_mm[b] - field.o_mm[a]) / static_cast<float>((high - low) * grid_.row_mm);
        // Lambert's cosine for light from straight ahead.
        cell.value[k_amplitude] += cell.runs * 0.5F * std::log1p(slope * slope);
        cell.slope = cell.runs * slope;
      } else {
        cell = {};
      }
      cell.runs += column[row].runs;
      cell.slope += column[row].slope;
      for (std::size_t c = 0; c < k_channels; ++c) cell.value[c] += column[row].value[c];
    }
  });
}

std::optional<Materials::Sums> Materials::mean(int col, int low, int high, double least_runs) const {
  if (low < 0 || high > rows_) return std::nullopt;
  const Sums* column = below_.data() + static_cast<std::size_t>(col) * (static_cast<std::size_t>(rows_) + 1);
  const Sums &under = column[low], &upto = column[high];
  const float runs = upto.runs - under.runs;
  if (static_cast<double>(runs) < least_runs) return std::nullopt;
  Sums result{.runs = runs, .value = {}, .slope = (upto.slope - under.slope) / runs};
  for (std::size_t c = 0; c < k_channels; ++c) result.value[c] = (upto.value[c] - under.value[c]) / runs;
  return result;
}

std::optional<Materials::Sums> Materials::step_at(int col, double height_mm, const Window& window) const {
  const auto row_at = [&](double mm) { return static_cast<int>(std::lround(mm / config_.row_mm)); };
  const auto above =
      mean(col, row_at(height_mm + window.from_mm), row_at(height_mm + window.above_mm), window.least_runs);
  if (!above) return std::nullopt;
  const auto under =
      mean(col, row_at(height_mm - window.below_mm), row_at(height_mm - window.from_mm), window.least_runs);
  if (!under) return std::nullopt;
  Sums step{.runs = 0, .value = {}, .slope = above->slope - under->slope};
  for (std::size_t c = 0; c < k_channels; ++c) step.value[c] = above->value[c] - under->value[c];
  return step;
}

std::vector<Materials::Sums> Materials::steps(const Window& window, double every_mm) const {
  std::vector<Sums> all;
  for (int col = 0; col < cols_; col += 2) {
    for (double at_mm = window.below_mm; at_mm < grid_.rows * grid_.row_mm; at_mm += every_mm) {
      if (const std::optional<Sums> step = step_at(col, at_mm, window)) all.push_back(*step);
    }
  }
  return all;
}

bool Materials::fit() {
  constexpr std::size_t k_least_steps = 100;
  constexpr int k_rounds = 4;
  constexpr double k_far = 2.0;  // of the noise: across another material, or on something else
  constexpr double k_steepest_light = 1.0;
  constexpr double k_sharp = 0.25;  // at an edge or a groove light is cut off and blurred
  constexpr double k_few_slopes = 1.0;
  const std::vector<Sums> near =
      steps({.from_mm = 0, .above_mm = 1.5, .below_mm = 1.5, .least_runs = config_.least_runs / 2}, 2.0);
  const std::vector<Sums> wide = steps(whole_window(), 2.0);
  if (near.size() < k_least_steps || wide.size() < k_least_steps) return false;
  std::vector<double> off;
  for (std::size_t c = 0; c < k_channels; ++c) {
    double within = 1e9;
    for (int round = 0; round < k_rounds; ++round) {
      double ss = 0, sv = 0;
      off.clear();
      for (const Sums& step : near) {
        off.push_back(std::abs(rest(step, c)));
        if (off.back() > within || std::abs(static_cast<double>(step.slope)) > k_sharp) continue;
        ss += static_cast<double>(step.slope * step.slope);
        sv += static_cast<double>(step.slope * step.value[c]);
      }
      // Where hardly a slope differs from the next one, light is taken to come from straight ahead.
      by_slope_[c] = std::clamp(sv / (ss + k_few_slopes), -k_steepest_light, k_steepest_light);
      within = k_far * k_sigma_per_median * median_of(off);
    }
    off.clear();
    for (const Sums& step : wide) off.push_back(std::abs(rest(step, c)));
    noise_[c] = std::max(c == k_amplitude ? config_.least_noise_amplitude : config_.least_noise_width,
                         k_sigma_per_median * median_of(off));
  }
  return true;
}

double Materials::contrast(std::span<const Sums> steps, std::size_t channel) const {
  std::vector<double> values, off, slopes;
  for (const Sums& step : steps) {
    values.push_back(rest(step, channel));
    slopes.push_back(static_cast<double>(step.slope));
  }
  const double median = median_of(values);
  for (const double value : values) off.push_back(std::abs(value - median));
  const double scatter = std::max(noise_[channel], k_sigma_per_median * median_of(off));
  return median / std::hypot(scatter, config_.light_spread * median_of(slopes));
}

std::optional<MaterialContrast> Materials::across(std::span<const int> path,
                                                  std::span<const int> beside) const {
  constexpr double k_least_height_mm = 1.0;
  std::vector<Sums> found;
  for (int col = 0; col < cols_; ++col) {
    const std::size_t at = std::min(
        path.size() - 1, static_cast<std::size_t>((col + 0.5) * static_cast<double>(path.size()) / cols_));
    Window window = whole_window();
    const double apart_mm = (beside[at] - path[at]) * grid_.row_mm;
    double& bounded_mm = apart_mm > 0 ? window.above_mm : window.below_mm;
    bounded_mm = std::min(bounded_mm, std::abs(apart_mm) - window.from_mm);
    if (bounded_mm < window.from_mm + k_least_height_mm) continue;
    const auto step = step_at(col, (path[at] + 0.5) * grid_.row_mm, window);
    if (step) found.push_back(*step);
  }
  if (static_cast<double>(found.size()) < config_.least_known_share * cols_) return std::nullopt;
  return MaterialContrast{.amplitude = contrast(found, k_amplitude), .width = contrast(found, k_width)};
}

double Materials::change(const MaterialContrast& found) const {
  const double most = std::max(std::abs(found.amplitude), std::abs(found.width));
  return std::clamp((most - config_.nothing) / (config_.plain - config_.nothing), 0.0, 1.0);
}

double Materials::favours(std::span<const int> line, std::span<const int> rival) const {
  const std::optional<MaterialContrast> at_line = across(line, rival);
  if (!at_line) return 0;
  const std::optional<MaterialContrast> at_rival = across(rival, line);
  return at_rival ? change(*at_line) - change(*at_rival) : 0;
}

}  // namespace biteline::bite_line
