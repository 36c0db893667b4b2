// SPDX-License-Identifier: MIT
#include "host/study/gage_study.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/csv/table.hpp"

namespace biteline::study {
namespace {

/// AIAG: an interaction less sure than this is taken as repeats.
constexpr double k_interaction_probability = 0.25;

double square(double x) {
  return x * x;
}

/// Of the regularised incomplete beta function: continued fraction by Lentz's method (Numerical
/// Recipes, 6.4).
double beta_fraction(double a, double b, double x) {
  constexpr double k_least = 1e-300, k_enough = 1e-15;
  constexpr int k_most_steps = 500;
  const auto away = [](double value) { return std::abs(value) < k_least ? k_least : value; };
  double c = 1, d = 1 / away(1 - (a + b) * x / (a + 1)), result = d;
  for (int m = 1; m < k_most_steps; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / away(1 + even * d);
    c = away(1 + even / c);
    result *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / away(1 + odd * d);
    c = away(1 + odd / c);
    result *= c * d;
    if (std::abs(c * d - 1) < k_enough) break;
  }
  return result;
}

double incomplete_beta(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const double logarithm =
      std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x);
  if (logarithm < -700) return x < (a + 1) / (a + b + 2) ? 0 : 1;
  const double front = std::exp(logarithm);
  return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a
                                   : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

using Cells = std::map<std::pair<std::string, std::string>, std::vector<double>>;

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Equal numbers of trials in every cell, and every cell there.
Result<void> check_balance(const GageStudy& study, const Cells& cells) {
  if (study.parts < 2 || study.persons < 2 || study.trials < 2)
    return fail(Errc::BadValue, "a study has at least 2 parts, 2 persons and 2 trials; found %d, %d and %d",
                study.parts, study.persons, study.trials);
  for (const auto& [who, values] : cells) {
    if (static_cast<int>(values.size()) != study.trials)
      return fail(Errc::BadValue, "person '%s' has %zu readings of part '%s', where %d are expected",
                  who.second.c_str(), values.size(), who.first.c_str(), study.trials);
  }
  if (static_cast<int>(cells.size()) != study.parts * study.persons)
    return fail(Errc::BadValue, "%zu of %d pairs of part and person were measured", cells.size(),
                study.parts * study.persons);
  return {};
}

double deviation(double variance) {
  return std::sqrt(std::max(0.0, variance));
}

void tell_deviations(GageStudy& study) {
  const double of_part = study.persons * study.trials, of_person = study.parts * study.trials;
  study.interaction_kept = study.interaction_probability <= k_interaction_probability;
  const Source pooled{.squares = study.of_both.squares + study.of_repeats.squares,
                      .freedom = study.of_both.freedom + study.of_repeats.freedom};
  const double repeats = study.interaction_kept ? study.of_repeats.mean_square() : pooled.mean_square(),
               against = study.interaction_kept ? study.of_both.mean_square() : repeats;
  study.ev = deviation(repeats);
  if (study.interaction_kept) study.interaction = deviation((against - repeats) / study.trials);
  study.av = deviation((study.of_persons.mean_square() - against) / of_person);
  study.pv = deviation((study.of_parts.mean_square() - against) / of_part);
  study.grr = std::hypot(study.ev, study.av, study.interaction);
  study.tv = std::hypot(study.grr, study.pv);
  if (study.grr > 0) study.ndc = std::max(1, static_cast<int>(1.41 * study.pv / study.grr));
}

}  // namespace

double chance_of_larger(double ratio, const Freedoms& freedoms) {
  const double above = freedoms.above, below = freedoms.below;
  return incomplete_beta(below / 2, above / 2, below / (below + above * ratio));
}

Result<GageStudy> gage_study(std::span<const Reading> readings) {
  Cells cells;
  std::map<std::string, std::vector<double>> parts, persons;
  std::vector<double> all;
  for (const Reading& reading : readings) {
    cells[{reading.part, reading.person}].push_back(reading.value);
    parts[reading.part].push_back(reading.value);
    persons[reading.person].push_back(reading.value);
    all.push_back(reading.value);
  }
  GageStudy study{.parts = static_cast<int>(parts.size()), .persons = static_cast<int>(persons.size())};
  study.trials = cells.empty() ? 0 : static_cast<int>(cells.begin()->second.size());
  BITELINE_TRY(check_balance(study, cells));

  const double grand = mean_of(all);
  double of_cells = 0;
  for (const auto& [name, values] : parts)
    study.of_parts.squares += static_cast<double>(values.size()) * square(mean_of(values) - grand);
  for (const auto& [name, values] : persons)
    study.of_persons.squares += static_cast<double>(values.size()) * square(mean_of(values) - grand);
  for (const auto& [who, values] : cells) {
    const double mean = mean_of(values);
    of_cells += study.trials * square(mean - grand);
    for (const double value : values) study.of_repeats.squares += square(value - mean);
  }
  if (of_cells + study.of_repeats.squares <= 0)
    return fail(Errc::BadValue, "all %zu readings are equal: there is nothing to study", all.size());
  study.of_both.squares = std::max(0.0, of_cells - study.of_parts.squares - study.of_persons.squares);
  study.of_parts.freedom = study.parts - 1;
  study.of_persons.freedom = study.persons - 1;
  study.of_both.freedom = study.of_parts.freedom * study.of_persons.freedom;
  study.of_repeats.freedom = study.parts * study.persons * (study.trials - 1);
  // Repeats that are all equal leave any interaction sure.
  study.interaction_probability =
      study.of_repeats.squares > 0
          ? chance_of_larger(study.of_both.mean_square() / study.of_repeats.mean_square(),
                             {.above = study.of_both.freedom, .below = study.of_repeats.freedom})
          : 0;
  tell_deviations(study);
  return study;
}

Result<std::vector<Reading>> read_readings(const std::filesystem::path& file) {
  std::vector<Reading> readings;
  BITELINE_TRY(csv::read_table(file, 3, 3, [&](const csv::Row& row) -> Result<void> {
    BITELINE_ASSIGN(const double value, row.number(2));
    readings.push_back(
        {.part = std::string{row.text(0)}, .person = std::string{row.text(1)}, .value = value});
    return {};
  }));
  return readings;
}

}  // namespace biteline::study
