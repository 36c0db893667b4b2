// SPDX-License-Identifier: MIT
#include "host/robot/path/force_learning.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "host/robot/path/force.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::path {
namespace {

constexpr double k_set_newton = 20;

double wave(double ratio) {
  return 2 * std::sin(4 * std::numbers::pi * ratio);
}

/// Round the line, what `told` says by the place, against x.
std::vector<ForceSample> samples_of(const std::function<double(double)>& pressed) {
  std::vector<ForceSample> samples;
  for (int i = 0; i < 5000; ++i) {
    const double ratio = i / 5000.0;
    samples.push_back({ratio, Vec3{-pressed(ratio), 0, 0}, Vec3::UnitX()});
  }
  return samples;
}

std::string grind_with(const std::string& rows) {
  std::ifstream file{std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml"};
  std::stringstream text;
  text << file.rdbuf();
  return text.str() + rows;
}

}  // namespace

TEST_GROUP(ForceLearning){};

/// A shoe that is pressed with the set force through a sensor whose error is known teaches nothing more.
TEST(ForceLearning, KnownErrorOfTheSensorIsNoMissingForce) {
  ForceLearned learned{.set_newton = k_set_newton};
  learn_air(learned, samples_of(wave));
  constexpr double k_begin = 0.3;
  // Zeroed at its beginning, the sensor tells the force with the error's change since.
  const auto told = [&](double ratio) { return k_set_newton + wave(ratio) - wave(k_begin); };
  learn_shoe(learned, samples_of(told), {.begin_ratio = k_begin});
  // Smoothing over one place of 144 takes (2 pi 2 / 144)^2 / 2 of a wave that goes twice round: 0.4 %.
  for (const double newton : learned.ahead_newton) DOUBLES_EQUAL(0, newton, 0.02);
}

/// What a regulator leaves out by the place comes ahead, and less is left with each shoe.
TEST(ForceLearning, MissingForceComesAheadShoeByShoe) {
  ForceLearned learned{.set_newton = k_set_newton};
  double left = 2;
  for (int shoe = 0; shoe < 4; ++shoe) {
    const auto told = [&](double ratio) {
      return k_set_newton - wave(ratio) + at_place(std::span<const double>{learned.ahead_newton}, ratio);
    };
    double worst = 0;
    for (int i = 0; i < 100; ++i) worst = std::max(worst, std::abs(told(i / 100.0) - k_set_newton));
    CHECK(worst <= left + 1e-9);
    left = worst;
    learn_shoe(learned, samples_of(told), {});
  }
  CHECK(left < 0.1);
  LONGS_EQUAL(4, learned.shoes);
}

TEST(ForceLearning, AheadStaysWithinHalfOfTheSetForce) {
  ForceLearned learned{.set_newton = k_set_newton};
  for (int shoe = 0; shoe < 5; ++shoe) learn_shoe(learned, samples_of([](double) { return 0.0; }), {});
  for (const double newton : learned.ahead_newton) DOUBLES_EQUAL(10, newton, 1e-9);
}

TEST(ForceLearning, FileKeepsWhatWasLearned) {
  const biteline::test::TemporaryFolder folder;
  ForceLearned learned{.set_newton = k_set_newton};
  learn_air(learned, samples_of(wave));
  learn_shoe(learned, samples_of([](double) { return 19.0; }), {});
  CHECK(write_force_learned(folder.path() / "force.yaml", learned).has_value());
  const Result<ForceLearned> read = read_force_learned(folder.path() / "force.yaml");
  CHECK(read.has_value());
  LONGS_EQUAL(1, read->shoes);
  LONGS_EQUAL(1, read->air_runs);
  for (std::size_t i = 0; i < k_force_places; ++i) {
    DOUBLES_EQUAL(learned.ahead_newton[i], read->ahead_newton[i], 0.0006);
    DOUBLES_EQUAL(0, (learned.error_tcp[i] - read->error_tcp[i]).norm(), 0.001);
  }
}

TEST(ForceLearning, ProcessTellsItsForce) {
  const auto parsed = parse_process(grind_with("force: {set_n: 20, contact_n: 4}\n"), "grind");
  CHECK(parsed.has_value());
  DOUBLES_EQUAL(20, parsed->process.force->set_newton, 1e-12);
  DOUBLES_EQUAL(4, parsed->process.force->contact_newton, 1e-12);
  CHECK_FALSE(parse_process(grind_with(""), "grind")->process.force.has_value());
  CHECK_FALSE(parse_process(grind_with("force: {set_n: 5}\n"), "grind").has_value());
  CHECK_FALSE(parse_process(grind_with("force: {set_n: 20, most_n: 21}\n"), "grind").has_value());
  // The tool would seem to stand: 3 mm at 1 mm/s against half of 2 s.
  CHECK_FALSE(parse_process(grind_with("force: {set_n: 20, approach_mm_s: 1}\n"), "grind").has_value());
}

}  // namespace biteline::path
