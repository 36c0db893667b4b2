// SPDX-License-Identifier: MIT
// Made shoes of eight cells: a disturbed one is named soon, sound ones never.
#include "host/fleet/odd_cell.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

namespace biteline::fleet {
namespace {

constexpr int k_cells = 8;

/// Lines as cells find them: each cell has a head of its own (0.015 mm), each shoe a way of standing (0.08
/// mm), each place its noise (0.1 mm).
struct MadeFleet {
  explicit MadeFleet(unsigned seed) : random{seed} {
    for (auto& offset : offsets) offset = 0.015 * normal(random);
  }
  PlacedShoe shoe(int cell, int number, double wider_mm, double aside_mm) {
    PlacedShoe made{.cell = std::string{"cell-"} + std::to_string(cell),
                    .scan = std::string{"scan-"} + std::to_string(number)};
    const double wide = offsets.at(static_cast<std::size_t>(cell)) + 0.08 * normal(random) + wider_mm;
    const double along = 0.08 * normal(random) + aside_mm;
    const double across = 0.08 * normal(random);
    for (std::size_t i = 0; i < made.places.size(); ++i) {
      const double angle =
          2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(made.places.size());
      made.places.at(i) = static_cast<float>(wide + along * std::cos(angle) + across * std::sin(angle) +
                                             0.1 * normal(random));
    }
    return made;
  }

  std::mt19937 random;
  std::normal_distribution<double> normal{};
  std::array<double, k_cells> offsets{};
};

/// 100 sound shoes of each cell, then cell 5 is disturbed; how many of its shoes until it is named, and
/// nobody else.
int shoes_until_named(unsigned seed, double wider_mm, double aside_mm) {
  MadeFleet fleet{seed};
  std::vector<PlacedShoe> shoes;
  for (int number = 0; number < 100; ++number) {
    for (int cell = 0; cell < k_cells; ++cell) shoes.push_back(fleet.shoe(cell, number, 0, 0));
  }
  CHECK(odd_cells(shoes).empty());
  for (int after = 1; after <= 60; ++after) {
    for (int cell = 0; cell < k_cells; ++cell) {
      const bool disturbed = cell == 5;
      shoes.push_back(fleet.shoe(cell, 99 + after, disturbed ? wider_mm : 0, disturbed ? aside_mm : 0));
    }
    const std::vector<OddCell> odd = odd_cells(shoes);
    if (odd.empty()) continue;
    LONGS_EQUAL(1, odd.size());
    STRCMP_EQUAL("cell-5", odd.front().cell.c_str());
    CHECK((odd.front().difference == Difference::Wider) == (wider_mm != 0));
    // What has just been named is told rather too large: it was named for its large values.
    DOUBLES_EQUAL(wider_mm + aside_mm, odd.front().mm, 0.1);
    CHECK(odd.front().u95_mm > 0 && odd.front().u95_mm < 0.08);
    return after;
  }
  return 61;
}

}  // namespace

TEST_GROUP(OddCell){};

TEST(OddCell, DisturbedCellIsNamedWithin30Shoes) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    for (const double sign : {1.0, -1.0}) {
      const int wider = shoes_until_named(seed, 0.15 * sign, 0);
      const int aside = shoes_until_named(seed, 0, 0.15 * sign);
      CHECK_TEXT(wider <= 30,
                 (std::string{"wider, seed "} + std::to_string(seed) + ": " + std::to_string(wider)).c_str());
      CHECK_TEXT(aside <= 30,
                 (std::string{"aside, seed "} + std::to_string(seed) + ": " + std::to_string(aside)).c_str());
    }
  }
}

TEST(OddCell, ThousandSoundShoesOfEachCellNameNobody) {
  for (unsigned seed = 21; seed <= 24; ++seed) {
    MadeFleet fleet{seed};
    std::vector<PlacedShoe> shoes;
    for (int number = 0; number < 1000; ++number) {
      for (int cell = 0; cell < k_cells; ++cell) shoes.push_back(fleet.shoe(cell, number, 0, 0));
    }
    const auto check_nobody = [&](std::span<const PlacedShoe> some) {
      const std::vector<OddCell> odd = odd_cells(some);
      CHECK_TEXT(odd.empty(),
                 odd.empty() ? "" : (odd.front().cell + " of seed " + std::to_string(seed)).c_str());
    };
    check_nobody(shoes);
    // As the centre asks, again and again: of the newest 300 of each.
    constexpr std::size_t k_newest = std::size_t{300} * k_cells, k_each = std::size_t{25} * k_cells;
    for (std::size_t end = k_newest; end <= shoes.size(); end += k_each)
      check_nobody(std::span{shoes}.subspan(end - k_newest, k_newest));
  }
}

TEST(OddCell, TooFewToCompareWithNameNobody) {
  MadeFleet fleet{3};
  std::vector<PlacedShoe> shoes;
  CHECK(odd_cells(shoes).empty());
  for (int number = 0; number < 200; ++number) {
    for (int cell = 0; cell < 3; ++cell) shoes.push_back(fleet.shoe(cell, number, cell == 0 ? 1 : 0, 0));
  }
  // Of two others nobody can say which one is right.
  CHECK(odd_cells(shoes).empty());
  std::vector<PlacedShoe> few;
  for (int number = 0; number < 5; ++number) {
    for (int cell = 0; cell < k_cells; ++cell) few.push_back(fleet.shoe(cell, number, cell == 0 ? 1 : 0, 0));
  }
  CHECK(odd_cells(few).empty());
}

TEST(OddCell, EqualPlacesAreNoSpreadOfZero) {
  std::vector<PlacedShoe> shoes;
  for (int number = 0; number < 50; ++number) {
    for (int cell = 0; cell < 5; ++cell)
      shoes.push_back({.cell = std::string{"cell-"} + std::to_string(cell),
                       .scan = std::to_string(number),
                       .places = {}});
  }
  CHECK(odd_cells(shoes).empty());
}

}  // namespace biteline::fleet
