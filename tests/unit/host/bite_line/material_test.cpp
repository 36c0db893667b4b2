// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/material.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <functional>
#include <vector>

#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line {
namespace {

constexpr double k_line_mm = 22, k_decoy_mm = 12;

/// Grooves of a wall at the line and at the decoy, the second one `ratio` as deep.
double two_grooves(double z, double ratio) {
  return test::groove_mm(z, k_line_mm) + ratio * test::groove_mm(z, k_decoy_mm);
}

/// The wall above the line leans in by 17 degrees, the sole goes in downwards by 9.
double leaning(double z) {
  const double above_mm = z - k_line_mm;
  return above_mm > 0 ? -0.3 * above_mm : 0.15 * above_mm;
}

std::vector<int> path_at(const Side& side, double z_mm) {
  const SideGrid& grid = side.field.grid;
  const double row = (z_mm - grid.z_low_mm) / grid.row_mm - 0.5;
  return std::vector<int>(static_cast<std::size_t>(grid.cols), static_cast<int>(std::lround(row)));
}

/// What each point's stripe looks like, told by its place along and up, with a coarse cloth's spread of 10 %.
using Grey = std::function<double(double s_mm, double z_mm)>;
std::vector<RunLook> looks(const Side& side, const Grey& grey, const Grey& width_px = {}) {
  std::vector<RunLook> looks;
  for (std::size_t i = 0; i < side.field.places.size(); ++i) {
    const auto s = static_cast<double>(side.field.places[i].s_mm);
    const auto z = static_cast<double>(side.field.places[i].z_mm);
    const double grain = 1 + 0.1 * std::sin(static_cast<double>(i) * 12.9898);
    looks.push_back({.log_amplitude = static_cast<float>(std::log(grain * grey(s, z))),
                     .log_width = static_cast<float>(std::log(width_px ? width_px(s, z) : 4.0))});
  }
  return looks;
}

double favours(const Side& side, const std::vector<RunLook>& looks) {
  const auto sut = Materials::of(side.shoe, side.field, looks);
  CHECK(sut.has_value());
  return sut->favours(path_at(side, k_line_mm), path_at(side, k_decoy_mm));
}

double grey_of(double z, double from_mm) {
  return z > from_mm ? 60 : 120;
}

}  // namespace

TEST_GROUP(Material) {
  const Side side = test::drum_side([](double, double z) { return two_grooves(z, 1); });
  void teardown() override {
    test::forgive_underflow();
  }
};

TEST(Material, OneColourSaysExactlyNothing) {
  DOUBLES_EQUAL(0, favours(side, looks(side, [](double, double) { return 90.0; })), 0);
}

TEST(Material, AnotherMaterialAboveTheLineSpeaksForItAndBelowADecoyForThat) {
  DOUBLES_EQUAL(1, favours(side, looks(side, [](double, double z) { return grey_of(z, k_line_mm); })), 0);
  DOUBLES_EQUAL(-1, favours(side, looks(side, [](double, double z) { return grey_of(z, k_decoy_mm); })), 0);
}

TEST(Material, WhatScattersLightShowsInTheWidth) {
  const auto one = [](double, double) { return 90.0; };
  DOUBLES_EQUAL(
      1, favours(side, looks(side, one, [](double, double z) { return z > k_line_mm ? 4.0 : 5.0; })), 0);
}

TEST(Material, ASoleOfTwoColoursUnderAnUpperOfAThirdSaysNothing) {
  DOUBLES_EQUAL(0,
                favours(side, looks(side,
                                    [](double, double z) {
                                      return z > k_line_mm ? 60.0 : z > k_decoy_mm ? 120.0 : 40.0;
                                    })),
                0);
}

TEST(Material, APieceOnPartOfTheWayRoundSaysNothing) {
  const double half_mm = side.outline.length_mm() / 2;
  DOUBLES_EQUAL(
      0,
      favours(side,
              looks(side, [&](double s, double z) { return s < half_mm ? grey_of(z, k_line_mm) : 60.0; })),
      0);
}

TEST(Material, LightThatFallsAtASlantOnSlopesIsNoMaterial) {
  const Side slopes = test::drum_side([](double, double z) { return leaning(z) + two_grooves(z, 1); });
  for (const double light_deg : {-20.0, 0.0, 20.0}) {
    const double light_rad = light_deg / 180 * std::numbers::pi;
    const auto lit = [&](double z) {
      const double lean_rad = std::atan((leaning(z - 0.1) - leaning(z + 0.1)) / 0.2);
      return std::max(0.05, std::cos(lean_rad - light_rad));
    };
    DOUBLES_EQUAL(0, favours(slopes, looks(slopes, [&](double, double z) { return 150 * lit(z); })), 0);
    DOUBLES_EQUAL(
        1,
        favours(slopes,
                looks(slopes, [&](double, double z) { return (z > k_line_mm ? 1 : 2) * 75 * lit(z); })),
        0.3);
  }
}

TEST(Material, WhereNothingIsKnownOfOneSideNothingIsSaid) {
  CHECK_FALSE(Materials::of(side.shoe, side.field, {}).has_value());
  std::vector<RunLook> none(side.field.places.size());
  CHECK_FALSE(Materials::of(side.shoe, side.field, none).has_value());
  std::vector<RunLook> half = looks(side, [](double, double z) { return grey_of(z, k_line_mm); });
  for (std::size_t i = 0; i < half.size(); ++i) {
    if (side.field.places[i].z_mm < 11) half[i] = {};
  }
  DOUBLES_EQUAL(0, favours(side, half), 0);
}

}  // namespace biteline::bite_line
