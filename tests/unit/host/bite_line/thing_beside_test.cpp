// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/bite_line/place/thing_beside.hpp"

namespace biteline::bite_line {
namespace {

constexpr double k_station_mm = 0.5;

/// Round an oval of 260 by 90 mm, anticlockwise; `out_mm(s)`: how far out it is pushed, s in mm.
template <class Out>
std::vector<PlacedStation> oval(Out&& out_mm) {
  std::vector<PlacedStation> stations;
  double angle = 0;
  for (double s_mm = 0; angle < 2 * std::numbers::pi; s_mm += k_station_mm) {
    const Vec2 along{-130 * std::sin(angle), 45 * std::cos(angle)};
    const Vec2 outwards = Vec2{along.y(), -along.x()}.normalized();
    const Vec2 place = Vec2{130 * std::cos(angle), 45 * std::sin(angle)} + out_mm(s_mm) * outwards;
    stations.push_back({.position = {place.x(), place.y(), 20}});
    angle += k_station_mm / along.norm();
  }
  return stations;
}

double nothing(double /*s_mm*/) {
  return 0;
}
/// A pin of 6 mm across that stands out by 10 mm, with flanks of 2 mm.
double pin(double s_mm) {
  return 10 * std::clamp(5 - std::abs(s_mm - 150), 0.0, 2.0) / 2;
}

}  // namespace

TEST_GROUP(ThingBeside){};

TEST(ThingBeside, AShoesOutlineHasNone) {
  std::vector<PlacedStation> sut = oval(nothing);
  doubt_things_beside(k_station_mm, sut);
  for (const PlacedStation& station : sut) DOUBLES_EQUAL(1, station.hold, 0);
}

TEST(ThingBeside, AWaistThatGoesInIsNone) {
  std::vector<PlacedStation> sut =
      oval([](double s_mm) { return -12 * std::exp(-std::pow((s_mm - 150) / 30, 2)); });
  doubt_things_beside(k_station_mm, sut);
  for (const PlacedStation& station : sut) DOUBLES_EQUAL(1, station.hold, 0);
}

TEST(ThingBeside, ALineThatFollowsTheRimOfAGapInwardsIsUnsureThere) {
  // 15 mm in and back over 28 mm, as on a shoe of which a sector was not seen on a slant.
  const auto bay = [](double s_mm) { return -15 * std::max(0.0, 1 - std::abs(s_mm - 150) / 14); };
  std::vector<PlacedStation> sut = oval(bay);
  doubt_things_beside(k_station_mm, sut);
  for (std::size_t i = 0; i < sut.size(); ++i) {
    const double s_mm = k_station_mm * static_cast<double>(i);
    if (bay(s_mm) < 0) CHECK(sut[i].hold < 0.5);
    if (std::abs(s_mm - 150) > 25) DOUBLES_EQUAL(1, sut[i].hold, 0);
    CHECK_FALSE(sut[i].thing_beside);
  }
}

TEST(ThingBeside, APinBesideTheShoeMakesTheLineRoundItUnsure) {
  CHECK_TEXT(ThingConfig{}.hold < 0.5, "below the limit");
  std::vector<PlacedStation> sut = oval(pin);
  doubt_things_beside(k_station_mm, sut);
  for (std::size_t i = 0; i < sut.size(); ++i) {
    const double s_mm = k_station_mm * static_cast<double>(i);
    if (pin(s_mm) > 0.5) {
      DOUBLES_EQUAL(ThingConfig{}.hold, sut[i].hold, 1e-9);
      DOUBLES_EQUAL(10, sut[i].other_mm, 1);
    } else if (std::abs(s_mm - 150) > 20) {
      DOUBLES_EQUAL(1, sut[i].hold, 0);
    }
  }
}

TEST(ThingBeside, ABridgeThatRunsOutToAPinOnASlantIsUnsure) {
  // 28 degrees out, and straight back: so it was on a scan with pictures, 6 mm off without a word.
  const auto slanted = [](double s_mm) {
    return std::max(0.0, std::min((s_mm - 138) * 6.4 / 12, (151.5 - s_mm) * 6.4 / 1.5));
  };
  std::vector<PlacedStation> sut = oval(slanted);
  doubt_things_beside(k_station_mm, sut);
  for (std::size_t i = 0; i < sut.size(); ++i) {
    if (slanted(k_station_mm * static_cast<double>(i)) > 0.5)
      DOUBLES_EQUAL(ThingConfig{}.hold, sut[i].hold, 1e-9);
  }
}

TEST(ThingBeside, ABluntCornerBetweenTwoSharpOnesHidesNothing) {
  // Straight out by 6 mm, along the shoe, 28 degrees farther out, and straight back.
  const auto stepped = [](double s_mm) {
    const double out_mm = 6 + std::max(0.0, s_mm - 160) * 6.4 / 12;
    return std::max(0.0, std::min({(s_mm - 130) * 4, out_mm, (174 - s_mm) * 6}));
  };
  std::vector<PlacedStation> sut = oval(stepped);
  doubt_things_beside(k_station_mm, sut);
  for (std::size_t i = 0; i < sut.size(); ++i) {
    if (stepped(k_station_mm * static_cast<double>(i)) > 0.5)
      DOUBLES_EQUAL(ThingConfig{}.hold, sut[i].hold, 1e-9);
  }
}

TEST(ThingBeside, TwoBluntCornersAreNone) {
  // 28 degrees out, and 28 back.
  std::vector<PlacedStation> sut =
      oval([](double s_mm) { return std::max(0.0, 12 - std::abs(s_mm - 150)) * 6.4 / 12; });
  doubt_things_beside(k_station_mm, sut);
  for (const PlacedStation& station : sut) DOUBLES_EQUAL(1, station.hold, 0);
}

TEST(ThingBeside, ASharpToeIsNone) {
  std::vector<PlacedStation> sut =
      oval([](double s_mm) { return 25 * std::max(0.0, 1 - std::abs(s_mm - 150) / 40); });
  doubt_things_beside(k_station_mm, sut);
  for (const PlacedStation& station : sut) DOUBLES_EQUAL(1, station.hold, 0);
}

}  // namespace biteline::bite_line
