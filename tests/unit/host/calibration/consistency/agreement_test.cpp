// SPDX-License-Identifier: MIT
#include "host/calibration/consistency/agreement.hpp"

#include <CppUTest/TestHarness.h>

#include <random>
#include <vector>

#include "host/calibration/consistency/refused.hpp"
#include "tests/support/refusals.hpp"

namespace biteline::consistency {
namespace {

constexpr int k_stretches = 6, k_profiles = 10, k_places = 6;

/// Places as the model has them: head off by its standard deviations times `head`, arm new in each stretch.
struct Drawn {
  double head{1}, arm_mm{0.03}, noise_mm{0.015}, rows{0};
  double per_column_mm{0.001};  ///< a column moves a place by so much, one way or the other
  unsigned seed{1};
};

std::vector<Crossing> drawn(const Drawn& draw) {
  std::mt19937 random{draw.seed};
  std::normal_distribution<double> normal;
  Vec3 z{normal(random), normal(random), normal(random)};
  z *= draw.head;
  std::vector<Crossing> crossings;
  for (int stretch = 0; stretch < k_stretches; ++stretch) {
    // Both views' errors.
    const double arm_mm = std::sqrt(2.0) * draw.arm_mm * normal(random);
    for (int i = 0; i < k_profiles * k_places; ++i) {
      Crossing crossing{
          .apart_mm = 0,
          .moves = SpreadRow::Zero(),
          .per_px = Eigen::RowVector2d{draw.per_column_mm * normal(random), 0.02 + 0.002 * normal(random)},
          .pose_sigma_mm = 0,
          .frame = static_cast<std::uint32_t>(stretch * k_profiles + i / k_places),
          .time_s = 0.2 * stretch + 0.1};
      crossing.moves.head<3>() << 0.02 * normal(random), 0.02 + 0.01 * normal(random), 0.01 * normal(random);
      crossing.apart_mm = crossing.moves.head<3>() * z + arm_mm + draw.noise_mm * normal(random) +
                          draw.rows * crossing.per_px.y();
      crossings.push_back(crossing);
    }
  }
  return crossings;
}

Agreement agreement(const Drawn& draw) {
  return agreement_of(drawn(draw), draw.arm_mm);
}

}  // namespace

TEST_GROUP(Agreement){};

TEST(Agreement, OfAScanAsItsCalibrationStatesHardlyOneInThousandsContradicts) {
  constexpr unsigned k_scans = 2000;
  int contradict = 0;
  double sum = 0;
  for (unsigned seed = 1; seed <= k_scans; ++seed) {
    const Agreement sut = agreement({.seed = seed});
    contradict += sut.contradicts() ? 1 : 0;
    sum += sut.statistic;
  }
  // 1e-4 each of three tests: 0.6 expected; five and more in one of 4000 such runs.
  CHECK_TEXT(contradict < 5, std::to_string(contradict).c_str());
  // A chi square's mean is its degrees of freedom.
  CHECK(sum / k_scans < k_stretches);
  CHECK(sum / k_scans > 0.3 * k_stretches);
}

TEST(Agreement, MovedPicturesAreToldFromTheStatedNumberOfRowsOn) {
  const Agreement sound = agreement({});
  CHECK(sound.tells_rows.has_value());
  int told = 0, below = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    told += agreement({.rows = 2.2 * *sound.tells_rows, .seed = seed}).contradicts() ? 1 : 0;
    below += agreement({.rows = 0.2 * *sound.tells_rows, .seed = seed}).contradicts() ? 1 : 0;
  }
  LONGS_EQUAL(50, told);
  LONGS_EQUAL(0, below);
}

TEST(Agreement, ItSaysByHowManyRows) {
  const Agreement sut = agreement({.head = 0, .arm_mm = 0.002, .noise_mm = 0.01, .rows = 12});
  DOUBLES_EQUAL(12, sut.moved_px.y(), 1);
}

TEST(Agreement, PlacesThatNoColumnMovesVouchForRowsOnly) {
  const Drawn quiet{.head = 0, .arm_mm = 0.002, .noise_mm = 0.01};
  const Agreement sut = agreement(quiet);
  CHECK(sut.rows_agree());
  CHECK_FALSE(sut.agrees());
  CHECK(*sut.tells_columns > 3 * *sut.tells_rows);
  Drawn both = quiet;
  both.per_column_mm = 0.05;
  CHECK(agreement(both).agrees());
}

TEST(Agreement, FewPlacesSayNothing) {
  std::vector<Crossing> crossings = drawn({.rows = 500});
  crossings.resize(19);
  const Agreement sut = agreement_of(crossings, 0.03);
  CHECK_FALSE(sut.enough());
  CHECK_FALSE(sut.contradicts());
  CHECK_FALSE(sut.agrees());
  CHECK_FALSE(agreement_of({}, 0.03).enough());
}

TEST(Agreement, SomeStrayPlacesAreNoContradiction) {
  std::vector<Crossing> crossings = drawn({.head = 0});
  for (std::size_t i = 0; i < crossings.size(); i += 70) crossings[i].apart_mm += 1;
  CHECK_FALSE(agreement_of(crossings, 0.03).contradicts());
}

TEST_GROUP(NotAsCalibrated){};

TEST(NotAsCalibrated, EachCodeHasItsRow) {
  test::check_refusal_table(Refused::NotAsCalibrated);
}

}  // namespace biteline::consistency
