// SPDX-License-Identifier: MIT
#include "host/bite_line/place/bare_doubt.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::bite_line {
namespace {

constexpr std::size_t k_count = 300;
constexpr double k_station_mm = 0.5;
constexpr double k_most_fade_mm = 8.5;

/// From station 100 on nothing shows over `bare` stations.  Beside these the crease is as sharp as told of
/// the stations from there, on both sides; it is 1/mm sharp elsewhere.
template <class Sharp>
std::vector<PlacedStation> doubted(std::size_t bare, Sharp&& k_per_mm) {
  Ridge ridge{.row = {},
              .k_per_mm = std::vector<double>(k_count, 1.0),
              .visible = std::vector<std::uint8_t>(k_count, 1),
              .other_k_per_mm = {},
              .other_mm = {}};
  std::vector<std::uint8_t> is_bare(k_count, 0);
  for (std::size_t i = 100; i < 100 + bare; ++i) {
    is_bare[i] = 1;
    ridge.visible[i] = 0;
    ridge.k_per_mm[i] = 0;
  }
  for (std::size_t k = 0; k < 40; ++k) {
    ridge.k_per_mm[99 - k] = k_per_mm(k);
    ridge.k_per_mm[100 + bare + k] = k_per_mm(k);
  }
  std::vector<PlacedStation> stations(k_count);
  doubt_bare(is_bare, ridge, k_station_mm, k_most_fade_mm, stations);
  return stations;
}

/// Whether these stations are doubted, and no others.
void check_doubted(const std::vector<PlacedStation>& sut, std::size_t first, std::size_t last) {
  for (std::size_t i = 0; i < sut.size(); ++i) {
    const bool doubted = i >= first && i <= last;
    CHECK_EQUAL(doubted, sut[i].doubt > 1);  // then it is there with less than one half
    CHECK_EQUAL(doubted, sut[i].untried);
  }
}

}  // namespace

TEST_GROUP(DoubtBare){};

TEST(DoubtBare, ALongStretchWithoutACreaseIsDoubtedAndAShortOneIsNot) {
  const auto sharp = [](std::size_t) { return 1.0; };
  check_doubted(doubted(32, sharp), 100, 131);
  check_doubted(doubted(30, sharp), 1, 0);
}

TEST(DoubtBare, TheCreaseThatFadesBesideItIsDoubtedToo) {
  check_doubted(doubted(40, [](std::size_t k) { return k < 8 ? 0.3 : 0.9; }), 92, 147);
  // One section that shows something sharp is no crease.
  check_doubted(doubted(40, [](std::size_t k) { return k < 8 && k != 4 ? 0.3 : 0.9; }), 92, 147);
}

TEST(DoubtBare, WhatIsAsFaintFarOnIsDoubtedNoFartherThanTheLinesMeanReaches) {
  check_doubted(doubted(40, [](std::size_t) { return 0.3; }), 83, 156);
}

TEST(DoubtBare, ALineOfWhichNothingWasSeenIsLeftToItsGaps) {
  Ridge ridge{.row = {},
              .k_per_mm = std::vector<double>(k_count, 0.0),
              .visible = std::vector<std::uint8_t>(k_count, 0),
              .other_k_per_mm = {},
              .other_mm = {}};
  std::vector<PlacedStation> stations(k_count);
  doubt_bare(std::vector<std::uint8_t>(k_count, 1), ridge, k_station_mm, k_most_fade_mm, stations);
  check_doubted(stations, 1, 0);
}

}  // namespace biteline::bite_line
