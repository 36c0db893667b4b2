// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include "host/bite_line/place/ridge_doubt.hpp"

namespace biteline::bite_line {
namespace {

constexpr std::size_t k_count = 200;
constexpr double k_steps = 16;  // of the running mean

bool all(std::size_t) {
  return true;
}

/// A ridge as sharp as 1/mm where it was `seen`; the other hollow 2 mm beside it is as sharp as told of each
/// station.
template <class Sharp, class Seen = bool (*)(std::size_t)>
std::vector<PlacedStation> doubted(Sharp&& other_k_per_mm, Seen&& seen = all) {
  Ridge ridge;
  for (std::size_t i = 0; i < k_count; ++i) {
    ridge.row.push_back(50);
    ridge.k_per_mm.push_back(seen(i) ? 1 : 0);
    ridge.visible.push_back(seen(i) ? 1 : 0);
    ridge.other_k_per_mm.push_back(seen(i) ? other_k_per_mm(i) : 0.0);
    ridge.other_mm.push_back(seen(i) ? 2 : 0);
  }
  std::vector<PlacedStation> stations(k_count);
  doubt_ridge(ridge, k_steps, stations);
  return stations;
}

}  // namespace

TEST_GROUP(DoubtRidge){};

TEST(DoubtRidge, OneWildSectionInThreeIsNoHollow) {
  for (const PlacedStation& station : doubted([](std::size_t i) { return i % 3 == 0 ? 9.0 : 0.0; }))
    CHECK_COMPARE(station.hold, >, 0.99);
}

TEST(DoubtRidge, AHollowThatIsSharperInMostSectionsMayBeTheLine) {
  for (const PlacedStation& station : doubted([](std::size_t i) { return i % 3 == 0 ? 0.0 : 1.5; })) {
    CHECK_COMPARE(station.hold, <, 0.01);
    DOUBLES_EQUAL(2, station.other_mm, 1e-9);
  }
}

TEST(DoubtRidge, WhoseMeanTakesAQuarterOfSuchAPlaceInIsAsUnsure) {
  const std::vector<PlacedStation> sut =
      doubted([](std::size_t i) { return i >= 60 && i < 120 ? 1.5 : 0.0; });
  // A point's mean takes in 8 stations to both sides: 4 of them and more lie in the place.
  for (std::size_t i = 56; i < 124; ++i) CHECK_COMPARE(sut[i].hold, <, 0.01);
  for (const std::size_t i : {50U, 54U, 125U, 130U}) CHECK_COMPARE(sut[i].hold, >, 0.99);
}

TEST(DoubtRidge, WhatIsBridgedHasNoVote) {
  // Two of three were not seen, and each that was shows another hollow.
  const std::vector<PlacedStation> most_bridged =
      doubted([](std::size_t) { return 1.5; }, [](std::size_t i) { return i % 3 == 0; });
  for (const PlacedStation& station : most_bridged) {
    CHECK_COMPARE(station.hold, <, 0.01);
    DOUBLES_EQUAL(2, station.other_mm, 1e-9);
  }
  // Where only one of eight was seen, a wild section would decide.
  for (const PlacedStation& station :
       doubted([](std::size_t) { return 1.5; }, [](std::size_t i) { return i % 8 == 0; }))
    CHECK_COMPARE(station.hold, >, 0.99);
}

TEST(DoubtRidge, WhatIsBridgedIsDoubtedElsewhere) {
  Ridge ridge{.row = std::vector<double>(k_count, 50),
              .k_per_mm = std::vector<double>(k_count, 0),
              .visible = std::vector<std::uint8_t>(k_count, 0),
              .other_k_per_mm = std::vector<double>(k_count, 0),
              .other_mm = std::vector<double>(k_count, 0)};
  std::vector<PlacedStation> stations(k_count);
  doubt_ridge(ridge, k_steps, stations);
  for (const PlacedStation& station : stations) CHECK_COMPARE(station.hold, >, 0.99);
}

TEST(DoubtRidge, ABridgeLeansOnBothItsEnds) {
  std::vector<std::uint8_t> known(k_count, 1);
  for (std::size_t i = 101; i < 120; ++i) known[i] = 0;
  std::vector<PlacedStation> sut(k_count);
  for (std::size_t i = 80; i <= 100; ++i) {
    sut[i].hold = 0.2;
    sut[i].other_mm = 4;
  }
  doubt_bridges(known, sut);
  for (std::size_t i = 101; i < 118; ++i) {
    DOUBLES_EQUAL(0.2, sut[i].hold, 1e-9);
    DOUBLES_EQUAL(4 * static_cast<double>(120 - i) / 20, sut[i].other_mm, 1e-9);
  }
  // Where it can be off by no more than what counts as right, it is sure; and so is its good end.
  for (const std::size_t i : {119U, 120U, 130U}) DOUBLES_EQUAL(1, sut[i].hold, 1e-9);
}

}  // namespace biteline::bite_line
