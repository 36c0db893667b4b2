// SPDX-License-Identifier: MIT
#include "host/bite_line/place/gap_bridge.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

#include "host/bite_line/place/point_spread.hpp"
#include "host/cloud/uncertainty/radius.hpp"

namespace biteline::bite_line {
namespace {

constexpr std::size_t k_stations = 1200;
constexpr double k_station_mm = 0.5;
constexpr geometry::Gap k_gap{.first = 200, .steps = 70};

double angle(std::size_t i) {
  return 2 * std::numbers::pi * static_cast<double>(i) / k_stations;
}

/// A ring of 600 mm whose radius swings by `swing_mm`, `times` round.
std::vector<Vec2> ring(double swing_mm, int times) {
  std::vector<Vec2> plan;
  for (std::size_t i = 0; i < k_stations; ++i) {
    const double radius =
        k_stations * k_station_mm / (2 * std::numbers::pi) + swing_mm * std::cos(times * angle(i));
    plan.emplace_back(radius * std::cos(angle(i)), radius * std::sin(angle(i)));
  }
  return plan;
}

std::vector<std::uint8_t> known_but(const geometry::Gap& gap) {
  std::vector<std::uint8_t> known(k_stations, 1);
  for (std::size_t k = 1; k < gap.steps; ++k) known[(gap.first + k) % k_stations] = 0;
  return known;
}

}  // namespace

TEST_GROUP(GapBridge){};

TEST(GapBridge, OnACircleABridgeIsNotOff) {
  DOUBLES_EQUAL(0, tried_plan(ring(0, 1), known_but(k_gap), k_gap, k_station_mm).at(0.5), 0.02);
}

TEST(GapBridge, BesideAJointItLiesBetweenTwoArcsAndSaysHowFarTheyAreApart) {
  std::vector<Vec2> plan = ring(0, 1);
  const Outline outline{plan, {}};
  const std::vector<std::uint8_t> known = known_but(k_gap);
  const PlanBridge plain = plan_bridge(plan, known, k_gap, outline, k_station_mm);
  CHECK(plain.firm);
  DOUBLES_EQUAL(0, plain.off_mm(0.5), 0.02);
  // The last 3 mm before the gap go out by 0.4 mm.
  const Vec2 truth = plan[(k_gap.first + k_gap.steps / 3) % k_stations];
  for (std::size_t k = 0; k < 6; ++k) {
    Vec2& place = plan[(k_gap.first + k_stations - k) % k_stations];
    place *= 1 + 0.4 * (1 - static_cast<double>(k) / 6) / place.norm();
  }
  const PlanBridge sut = plan_bridge(plan, known, k_gap, outline, k_station_mm);
  const double of_one = (sut.one.at(1.0 / 3).head<2>() - truth).norm();
  const double of_both = (sut.at(1.0 / 3) - truth).norm();
  CHECK_COMPARE(of_both, <, of_one);
  // The directions are off by 1.5 times 0.4 mm over 6 and over 12 mm.  A third across 35 mm that is 0.15 of
  // the length, and half of the difference is told.
  CHECK_COMPARE(sut.off_mm(1.0 / 3), >, 0.1);
}

TEST(GapBridge, OnALineThatBendsItIsOffByWhatItBends) {
  // Its own gap is bridged as badly as the others: the RMS over all of them tells of it.
  const std::vector<Vec2> plan = ring(2, 12);
  const double sut = tried_plan(plan, known_but(k_gap), k_gap, k_station_mm).at(0.5);
  double square = 0;
  for (std::size_t i = 0; i < k_stations; ++i) {
    const geometry::Gap own{.first = i, .steps = k_gap.steps};
    const Vec2 middle = gap_arc(plan, own, k_station_mm).at(0.5).head<2>();
    const double off = middle.norm() - plan[(i + k_gap.steps / 2) % k_stations].norm();
    square += off * off / k_stations;
  }
  CHECK_COMPARE(std::sqrt(square), >, 0.5);
  DOUBLES_EQUAL(std::sqrt(square), sut, 0.2 * std::sqrt(square));
}

TEST(GapBridge, WhereALineKinksTheErrorGrowsStraightFromTheEnds) {
  // A regular polygon: an end that lies beside a corner goes on straight, and the line does not.
  std::vector<Vec2> plan;
  constexpr std::size_t k_sides = 6;
  for (std::size_t i = 0; i < k_stations; ++i) {
    const double share = static_cast<double>(i * k_sides % k_stations) / k_stations;
    const std::size_t side = i * k_sides / k_stations;
    const auto corner = [](std::size_t k) {
      const double at = 2 * std::numbers::pi * static_cast<double>(k) / k_sides;
      return Vec2{100 * std::cos(at), 100 * std::sin(at)};
    };
    plan.emplace_back((1 - share) * corner(side) + share * corner(side + 1));
  }
  const TriedBridge sut = tried_plan(plan, known_but(k_gap), k_gap, k_station_mm);
  const double straight = sut.at(0.5) / 4;
  const double swelling = sut.at(0.5) * gap_swell(0.125);
  CHECK_COMPARE(sut.at(0.5), >, 0.5);
  CHECK_COMPARE(sut.at(0.125), >, 0.5 * (straight + swelling));
  DOUBLES_EQUAL(0, sut.at(0), 1e-12);
  DOUBLES_EQUAL(sut.at(0.2), sut.at(0.8), 1e-12);
  DOUBLES_EQUAL(0.5 * (sut.rms_mm.at(1) + sut.rms_mm.at(2)), sut.at(2.5 / 8), 1e-12);
}

TEST(GapBridge, HeightsAreTriedTheSameWay) {
  std::vector<double> level(k_stations, 20.0);
  DOUBLES_EQUAL(0, tried_height(level, known_but(k_gap), k_gap, k_station_mm).at(0.5), 1e-9);
  std::vector<double> wavy;
  for (std::size_t i = 0; i < k_stations; ++i) wavy.push_back(20 + 2 * std::sin(12 * angle(i)));
  CHECK_COMPARE(tried_height(wavy, known_but(k_gap), k_gap, k_station_mm).at(0.5), >, 0.3);
}

TEST(GapBridge, WhereLittleWasSeenNothingIsTried) {
  std::vector<std::uint8_t> known(k_stations, 0);
  for (std::size_t i = 0; i < 90; ++i) known[i] = 1;
  DOUBLES_EQUAL(0, tried_plan(ring(2, 12), known, k_gap, k_station_mm).at(0.5), 1e-9);
}

TEST(GapBridge, ABridgeThatFailsElsewhereIsNotTrusted) {
  PlacedStation sut;
  sut.to_visible_mm = 15;
  sut.doubt = 0.5;
  const PointSpread trusted = spread_of(sut);
  sut.tried_out_mm = 1.3;
  const PointSpread tried = spread_of(sut);
  const auto u95 = [](const PointSpread& spread) {
    return uncertainty::u95_mm(uncertainty::principal_axes(spread.covariance_mm2), 1, 0);
  };
  CHECK_COMPARE(u95(trusted), <, 0.8);
  CHECK_COMPARE(u95(tried), >, 1.5);
  CHECK_COMPARE(trusted.within, >, 0.95);
  CHECK_COMPARE(tried.within, <, 0.5);
}

}  // namespace biteline::bite_line
