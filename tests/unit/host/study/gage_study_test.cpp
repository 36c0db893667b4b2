// SPDX-License-Identifier: MIT
#include "host/study/gage_study.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <fstream>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::study {
namespace {

constexpr int k_parts = 10, k_persons = 3, k_trials = 3;
constexpr double k_tolerance = 1e-9;

/// AIAG, Measurement Systems Analysis, 4th edition, chapter III: 10 parts, 3 appraisers, 3 trials.
constexpr double k_manual[k_persons][k_trials][k_parts] = {
    {{0.29, -0.56, 1.34, 0.47, -0.80, 0.02, 0.59, -0.31, 2.26, -1.36},
     {0.41, -0.68, 1.17, 0.50, -0.92, -0.11, 0.75, -0.20, 1.99, -1.25},
     {0.64, -0.58, 1.27, 0.64, -0.84, -0.21, 0.66, -0.17, 2.01, -1.31}},
    {{0.08, -0.47, 1.19, 0.01, -0.56, -0.20, 0.47, -0.63, 1.80, -1.68},
     {0.25, -1.22, 0.94, 1.03, -1.20, 0.22, 0.55, 0.08, 2.12, -1.62},
     {0.07, -0.68, 1.34, 0.20, -1.28, 0.06, 0.83, -0.34, 2.19, -1.50}},
    {{0.04, -1.38, 0.88, 0.14, -1.46, -0.29, 0.02, -0.46, 1.77, -1.49},
     {-0.11, -1.13, 1.09, 0.20, -1.07, -0.67, 0.01, -0.56, 1.45, -1.77},
     {-0.15, -0.96, 0.67, 0.11, -1.45, -0.49, 0.21, -0.49, 1.87, -2.16}}};

std::vector<Reading> manual_readings() {
  std::vector<Reading> readings;
  for (int person = 0; person < k_persons; ++person)
    for (int trial = 0; trial < k_trials; ++trial)
      for (int part = 0; part < k_parts; ++part)
        readings.push_back({.part = std::to_string(part),
                            .person = std::string(1, static_cast<char>('A' + person)),
                            .value = k_manual[person][trial][part]});
  return readings;
}

/// Sums of squares by the other way: totals squared, less the correction term, in long numbers.
struct BySums {
  long double part{0}, person{0}, cell{0}, all{0};

  BySums() {
    long double total = 0;
    for (int part_at = 0; part_at < k_parts; ++part_at) {
      long double sum = 0;
      for (int o = 0; o < k_persons; ++o)
        for (int t = 0; t < k_trials; ++t) sum += k_manual[o][t][part_at];
      part += sum * sum / (k_persons * k_trials);
      total += sum;
    }
    for (const auto& of_person : k_manual) {
      long double sum = 0;
      for (int p = 0; p < k_parts; ++p) {
        long double of_cell = 0;
        for (int t = 0; t < k_trials; ++t) {
          of_cell += of_person[t][p];
          all += static_cast<long double>(of_person[t][p]) * of_person[t][p];
        }
        cell += of_cell * of_cell / k_trials;
        sum += of_cell;
      }
      person += sum * sum / (k_parts * k_trials);
    }
    const long double correction = total * total / (k_parts * k_persons * k_trials);
    for (long double* value : {&part, &person, &cell, &all}) *value -= correction;
  }
};

}  // namespace

TEST_GROUP(GageStudyOfTheManual) {
  BySums sums{};
  GageStudy sut = *gage_study(manual_readings());
};

TEST(GageStudyOfTheManual, SumsOfSquaresAreTheOtherWays) {
  DOUBLES_EQUAL(static_cast<double>(sums.part), sut.of_parts.squares, k_tolerance);
  DOUBLES_EQUAL(static_cast<double>(sums.person), sut.of_persons.squares, k_tolerance);
  DOUBLES_EQUAL(static_cast<double>(sums.cell - sums.part - sums.person), sut.of_both.squares, k_tolerance);
  DOUBLES_EQUAL(static_cast<double>(sums.all - sums.cell), sut.of_repeats.squares, k_tolerance);
}

TEST(GageStudyOfTheManual, DeviationsAreThoseOfTheSums) {
  // The interaction is by chance, so it is taken as repeats: 18 + 60 degrees of freedom.
  const double repeats = static_cast<double>((sums.all - sums.part - sums.person) / 78);
  const double ev = std::sqrt(repeats), av = std::sqrt((static_cast<double>(sums.person) / 2 - repeats) / 30),
               pv = std::sqrt((static_cast<double>(sums.part) / 9 - repeats) / 9);
  CHECK_FALSE(sut.interaction_kept);
  DOUBLES_EQUAL(ev, sut.ev, k_tolerance);
  DOUBLES_EQUAL(av, sut.av, k_tolerance);
  DOUBLES_EQUAL(pv, sut.pv, k_tolerance);
  DOUBLES_EQUAL(std::sqrt(ev * ev + av * av), sut.grr, k_tolerance);
  DOUBLES_EQUAL(std::sqrt(ev * ev + av * av + pv * pv), sut.tv, k_tolerance);
}

TEST(GageStudyOfTheManual, ThePrintedFiguresAreMet) {
  DOUBLES_EQUAL(88.3619, sut.of_parts.squares, 5e-5);
  DOUBLES_EQUAL(3.1673, sut.of_persons.squares, 5e-5);
  DOUBLES_EQUAL(0.3590, sut.of_both.squares, 5e-5);
  DOUBLES_EQUAL(2.7589, sut.of_repeats.squares, 5e-5);
  DOUBLES_EQUAL(0.199933, sut.ev, 5e-7);
  DOUBLES_EQUAL(0.226838, sut.av, 5e-7);
  DOUBLES_EQUAL(0.302373, sut.grr, 5e-6);
  DOUBLES_EQUAL(1.042327, sut.pv, 5e-6);
  DOUBLES_EQUAL(1.0853, sut.tv, 5e-5);
  DOUBLES_EQUAL(27.86, sut.grr_percent(), 5e-3);
  LONGS_EQUAL(4, sut.ndc);
}

TEST_GROUP(GageStudy){};

TEST(GageStudy, AnInteractionThatIsSureIsKept) {
  std::vector<Reading> readings = manual_readings();
  for (Reading& reading : readings)
    if (reading.person == "C" && reading.part < "5") reading.value += 2;
  const GageStudy sut = *gage_study(readings);
  CHECK_TRUE(sut.interaction_kept);
  CHECK(sut.interaction_probability < 1e-6);
  DOUBLES_EQUAL(std::sqrt((sut.of_both.mean_square() - sut.of_repeats.mean_square()) / k_trials),
                sut.interaction, k_tolerance);
  DOUBLES_EQUAL(std::sqrt(sut.of_repeats.mean_square()), sut.ev, k_tolerance);
}

TEST(GageStudy, MissingReadingsAreNamed) {
  std::vector<Reading> readings = manual_readings();
  readings.pop_back();
  CHECK_FALSE(gage_study(readings).has_value());
  CHECK_FALSE(gage_study({}).has_value());
}

TEST(GageStudy, EqualReadingsAreNoStudy) {
  std::vector<Reading> readings = manual_readings();
  for (Reading& reading : readings) reading.value = 1;
  CHECK_FALSE(gage_study(readings).has_value());
}

TEST(GageStudy, ChanceOfAnFIsThatOfTables) {
  DOUBLES_EQUAL(0.05, chance_of_larger(4.0012, {.above = 1, .below = 60}), 1e-5);
  DOUBLES_EQUAL(0.05, chance_of_larger(2.3928, {.above = 9, .below = 20}), 1e-5);
  // With two degrees above it is (1 + 2 F / n)^(-n / 2).
  DOUBLES_EQUAL(std::pow(1 + 2 * 3.0 / 12, -6), chance_of_larger(3, {.above = 2, .below = 12}), 1e-12);
  DOUBLES_EQUAL(1, chance_of_larger(0, {.above = 3, .below = 7}), 1e-12);
}

TEST(GageStudy, ReadsATable) {
  const test::TemporaryFolder folder;
  std::ofstream{folder.path() / "readings.csv"} << "#part,person,value\n7,Ana,1.5\n8,Bo,-2\n";
  const auto readings = read_readings(folder.path() / "readings.csv");
  SUCCEEDS(readings);
  LONGS_EQUAL(2, readings->size());
  STRCMP_EQUAL("Bo", (*readings)[1].person.c_str());
  DOUBLES_EQUAL(-2, (*readings)[1].value, 0);
}

}  // namespace biteline::study
