// SPDX-License-Identifier: MIT
#include "host/robot/path/force_learning.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/config/yaml_reader.hpp"
#include "common/core/fixed_text.hpp"
#include "host/geometry/closed_curve.hpp"
#include "host/report/report.hpp"
#include "host/robot/path/force.hpp"

namespace biteline::path {
namespace {

/// Later shoes still count: an arm's sensor and a tool change with the weeks.
constexpr double k_first_gain = 0.9, k_least_gain = 0.35;
constexpr double k_most_ahead_ratio = 0.5;
constexpr double k_smooth_places = 1;
constexpr std::array k_error_keys{"error_x_n", "error_y_n", "error_z_n"};

/// Places without a value between those that have one: evenly over the gap, round the line.
void fill_gaps(std::vector<Vec3>& values, const std::vector<int>& counts) {
  const std::size_t n = values.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (counts[i] > 0) continue;
    std::size_t before = 1, after = 1;
    while (counts[(i + n - before) % n] == 0) ++before;
    while (counts[(i + after) % n] == 0) ++after;
    const double part = static_cast<double>(before) / static_cast<double>(before + after);
    values[i] = (1 - part) * values[(i + n - before) % n] + part * values[(i + after) % n];
  }
}

void size_up(ForceLearned& learned) {
  learned.error_tcp.resize(k_force_places, Vec3::Zero());
  learned.ahead_newton.resize(k_force_places, 0.0);
}

Vec3 mean_of(const std::vector<Vec3>& values) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

std::vector<Vec3> by_place(std::span<const ForceSample> samples, Vec3 ForceSample::*value) {
  std::vector<Vec3> values(k_force_places, Vec3::Zero());
  std::vector<int> counts(k_force_places, 0);
  for (const ForceSample& sample : samples) {
    // The nearest place, as a table's value is that at its place.
    const double place = std::round(sample.round_ratio * static_cast<double>(k_force_places));
    if (!std::isfinite(place) || !(sample.*value).allFinite()) continue;
    const auto index = static_cast<std::size_t>(std::max(0.0, place)) % k_force_places;
    values[index] += sample.*value;
    ++counts[index];
  }
  if (std::ranges::all_of(counts, [](int count) { return count == 0; })) return values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] /= std::max(1, counts[i]);
  fill_gaps(values, counts);
  return geometry::smooth_closed<Vec3>(values, k_smooth_places, Vec3::Zero());
}

void learn_air(ForceLearned& learned, std::span<const ForceSample> samples) {
  size_up(learned);
  const std::vector<Vec3> told = by_place(samples, &ForceSample::told_tcp);
  const Vec3 level = mean_of(told);
  const double gain = 1.0 / ++learned.air_runs;
  for (std::size_t i = 0; i < k_force_places; ++i)
    learned.error_tcp[i] += gain * (told[i] - level - learned.error_tcp[i]);
}

void learn_shoe(ForceLearned& learned, std::span<const ForceSample> samples, const ShoePlace& place) {
  size_up(learned);
  if (samples.empty()) return;
  const std::vector<Vec3> told = by_place(samples, &ForceSample::told_tcp),
                          press = by_place(samples, &ForceSample::press_tcp);
  const Vec3 zero = at_place(std::span<const Vec3>{learned.error_tcp}, place.begin_ratio);
  const double gain = std::max(k_least_gain, k_first_gain / ++learned.shoes);
  std::vector<double> missing;
  const double most_newton = k_most_ahead_ratio * learned.set_newton;
  for (std::size_t i = 0; i < k_force_places; ++i) {
    const Vec3 on_tool = told[i] - (learned.error_tcp[i] - zero);
    missing.push_back(learned.set_newton + on_tool.dot(press[i].normalized()));
  }
  for (std::size_t i = 0; i < k_force_places; ++i) {
    const double here = static_cast<double>(i) / k_force_places + place.lead_ratio;
    learned.ahead_newton[i] =
        std::clamp(learned.ahead_newton[i] + gain * at_place(std::span<const double>{missing}, here),
                   -most_newton, most_newton);
  }
}

ForceDrift drift_of(const ForceLearned& learned) {
  ForceDrift drift;
  for (const Vec3& error : learned.error_tcp) drift.error_newton = std::max(drift.error_newton, error.norm());
  for (const double ahead : learned.ahead_newton)
    drift.ahead_newton = std::max(drift.ahead_newton, std::abs(ahead));
  return drift;
}

Result<ForceLearned> read_force_learned(const std::filesystem::path& file) {
  BITELINE_ASSIGN(config::YamlReader reader, config::YamlReader::open(file));
  ForceLearned learned;
  const NumberRange count{.minimum = 0, .maximum = 1e6}, newton{.minimum = -200, .maximum = 200};
  learned.set_newton = reader.number("set_n", {.minimum = 0, .maximum = 200});
  learned.air_runs = static_cast<int>(reader.number("air_runs", count));
  learned.shoes = static_cast<int>(reader.number("shoes", count));
  learned.error_tcp.resize(k_force_places);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::vector<double> values = reader.numbers(k_error_keys.at(axis), k_force_places, newton);
    for (std::size_t i = 0; i < std::min(values.size(), k_force_places); ++i)
      learned.error_tcp[i][axis] = values[i];
  }
  learned.ahead_newton = reader.numbers("ahead_n", k_force_places, newton);
  BITELINE_TRY(reader.finish());
  return learned;
}

Result<void> write_force_learned(const std::filesystem::path& file, const ForceLearned& learned) {
  std::string text =
      "# Of the tool's force on one model: by even places round the line, from the heel's end.\n";
  text += FixedText<200>::format("set_n: %.3f\nair_runs: %d\nshoes: %d\n", learned.set_newton,
                                 learned.air_runs, learned.shoes)
              .view();
  const auto list = [&](const char* key, std::vector<double> values) {
    values.resize(k_force_places, 0.0);
    text += std::string{key} + ": [";
    for (std::size_t i = 0; i < values.size(); ++i)
      text += FixedText<40>::format(i == 0 ? "%.3f" : ", %.3f", values[i]).view();
    text += "]\n";
  };
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vec3& error : learned.error_tcp) values.push_back(error[axis]);
    list(k_error_keys.at(axis), values);
  }
  list("ahead_n", learned.ahead_newton);
  return report::write_file_atomically(file, text);
}

}  // namespace biteline::path
