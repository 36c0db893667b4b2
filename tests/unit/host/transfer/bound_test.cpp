// SPDX-License-Identifier: MIT
// The stated bound against the truth, on lasts that differ smoothly.  The whole table: bench_transfer_bound.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>

#include "hal/sim/shoe/random.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/last_pair.hpp"

namespace biteline::transfer {
namespace {

double distance_mm(const Vec3& point, const cloud::ClosedLine& line) {
  double best = 1e9;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const Vec3 a = line.points[i].position, d = line.points[(i + 1) % line.points.size()].position - a;
    const double share = std::clamp((point - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (a + share * d - point).squaredNorm());
  }
  return std::sqrt(best);
}

Transfer transferred(const test::MadePair& pair) {
  return transfer_line({.cloud = pair.sample_cloud, .line = pair.sample_line}, pair.upper_cloud, {});
}

}  // namespace

TEST_GROUP(Bound){};

TEST(Bound, HoldsNineteenPointsOfTwenty) {
  // All points of a pair are off together, so a pair is one draw: the share within the bound has at most the
  // standard deviation of a coin that falls right 19 times of 20.
  constexpr int k_pairs = 18;
  const double tol = 3 * std::sqrt(0.95 * 0.05 / k_pairs);
  double within = 0, within_u95 = 0;
  int found = 0;
  for (int i = 0; i < k_pairs; ++i) {
    const auto seed = static_cast<std::uint64_t>(700 + i);
    const test::MadePair pair = test::last_pair(
        {.seed = seed,
         .difference_rms_mm = 0.12,
         .waves = static_cast<test::Waves>(i % 3),
         .collar = static_cast<test::Collar>(i % static_cast<int>(test::k_collar_names.size())),
         .feather_seen = i % 2 == 0});
    const Transfer sut = transferred(pair);
    if (!sut.found) continue;
    ++found;
    double pairs_within = 0, pairs_within_u95 = 0;
    for (const cloud::LinePoint& p : sut.carried.line.points) {
      const double error_mm = distance_mm(p.position, pair.upper_line);
      pairs_within += error_mm <= sut.bound_mm ? 1 : 0;
      pairs_within_u95 += error_mm <= p.u95_mm.value_or(0) ? 1 : 0;
    }
    within += pairs_within / static_cast<double>(sut.carried.line.points.size());
    within_u95 += pairs_within_u95 / static_cast<double>(sut.carried.line.points.size());
  }
  CHECK(found >= k_pairs - 3);  // the others say that the height is not fixed
  CHECK_COMPARE(within / found, >=, 0.95 - tol);
  CHECK_COMPARE(within_u95 / found, >=, 0.95 - tol);
}

TEST(Bound, OneEdgeInBothScansFixesTheHeight) {
  constexpr int k_pairs = 6;
  double sum_mm = 0, points = 0;
  int used = 0;
  for (std::uint64_t seed = 601; seed < 601 + k_pairs; ++seed) {
    const test::MadePair pair = test::last_pair({.seed = seed, .difference_rms_mm = 0.12});
    const Transfer sut = transferred(pair);
    CHECK_TEXT(sut.found, sut.reason().c_str());
    if (sut.alignment.rim_used) {
      ++used;
      CHECK(sut.alignment.next_step.empty());
      CHECK_COMPARE(sut.bound_mm, <=, 0.3);
    }
    points += static_cast<double>(sut.carried.line.points.size());
    for (const cloud::LinePoint& p : sut.carried.line.points)
      sum_mm += distance_mm(p.position, pair.upper_line);
  }
  CHECK(used >= k_pairs - 1);  // rarely the wall contradicts a true edge: none of 84 in the bench
  CHECK_COMPARE(sum_mm / points, <=, 0.08);
}

TEST(Bound, AnEdgeOutOfViewIsAskedFor) {
  const test::MadePair pair = test::last_pair({.seed = 804, .collar = test::Collar::UpperCut});
  const Transfer sut = transferred(pair);
  CHECK_FALSE(sut.alignment.rim_used);
  STRCMP_CONTAINS("raise the head by", sut.alignment.next_step.c_str());
  STRCMP_CONTAINS("the collar's edge is out of view", sut.alignment.next_step.c_str());
}

TEST(Bound, EdgesCutByOneTemplateAtOtherHeightsAreNotOneEdge) {
  // 1.8 mm apart is more than the wall leaves open.
  test::MadePair pair = test::last_pair({.seed = 805, .difference_rms_mm = 0.05});
  cloud::PointCloud cut;
  const SE3 T_shoe_base = pair.T_base_upper.inverse();
  const sim::MadeShoe shoe{sim::draw_shoe(sim::ShoeClass::Deep, 805)};
  const double profiles = 1 + static_cast<double>(pair.upper_cloud.profile.back());
  for (std::size_t i = 0; i < pair.upper_cloud.size(); ++i) {
    const double s_mm = shoe.perimeter_mm() * pair.upper_cloud.profile[i] / profiles;
    const double z_mm = (T_shoe_base * pair.upper_cloud.points[i].cast<double>()).z();
    if (z_mm > shoe.section(s_mm).top_z_mm() - 1.8) continue;
    cut.points.push_back(pair.upper_cloud.points[i]);
    cut.profile.push_back(pair.upper_cloud.profile[i]);
    cut.column.push_back(pair.upper_cloud.column[i]);
  }
  pair.upper_cloud = cut;
  const Transfer sut = transferred(pair);
  CHECK_FALSE(sut.alignment.rim_used);
  CHECK_TEXT(sut.found, sut.reason().c_str());
  double sum_mm = 0;
  for (const cloud::LinePoint& p : sut.carried.line.points)
    sum_mm += distance_mm(p.position, pair.upper_line);
  CHECK_COMPARE(sum_mm / static_cast<double>(sut.carried.line.points.size()), <=, sut.bound_mm);
}

TEST(Bound, HoldsWhatTheUppersScanDoesNotKnow) {
  const test::MadePair pair = test::last_pair({.seed = 700, .difference_rms_mm = 0.12, .feather_seen = true});
  const transfer::SampleFiles sample{.cloud = pair.sample_cloud, .line = pair.sample_line};
  const Transfer alone = transfer_line(sample, pair.upper_cloud, {});
  const double sigma_mm = 0.1;
  TransferOptions options;
  options.upper_scan.arm = uncertainty::ArmMotion{
      .sigma_mm = sigma_mm, .profiles = 1, .places = {{.middle_base = Vec3::Zero(), .sigma_mm = sigma_mm}}};
  const Transfer sut = transfer_line(sample, pair.upper_cloud, options);
  // Off alike both ways across the line: Rayleigh's distribution.
  const double arm_u95_mm = sigma_mm * std::sqrt(-2 * std::log(0.05));
  LONGS_EQUAL(alone.carried.line.points.size(), sut.carried.line.points.size());
  for (std::size_t i = 0; i < sut.carried.line.points.size(); ++i) {
    const cloud::LinePoint &before = alone.carried.line.points[i], &after = sut.carried.line.points[i];
    DOUBLES_EQUAL(std::hypot(*before.u95_mm, arm_u95_mm), *after.u95_mm, 1e-3);
    CHECK(after.confidence < before.confidence);
  }
  CHECK(sut.bound_mm > arm_u95_mm);
  CHECK(sut.arm && !sut.head_u95);
}

TEST(Bound, ALineWithMoreThanATenthFlaggedIsNone) {
  const test::MadePair pair = test::last_pair({.seed = 700, .difference_rms_mm = 0.12, .feather_seen = true});
  for (const auto& [share, is_line] : {std::pair{0.08, true}, std::pair{0.13, false}}) {
    transfer::SampleFiles sample{.cloud = pair.sample_cloud, .line = pair.sample_line};
    const auto unsure = static_cast<std::size_t>(share * static_cast<double>(sample.line.points.size()));
    for (std::size_t i = 0; i < unsure; ++i) sample.line.points[i].confidence = 0.4;
    const Transfer sut = transfer_line(sample, pair.upper_cloud, {});
    CHECK_EQUAL(is_line, sut.found);
    CHECK_EQUAL(is_line, !sut.carried.line.points.empty());
    if (is_line) continue;
    CHECK(sut.refusal->code == Refused::TooMuchUnsure);
    STRCMP_CONTAINS("% of the carried line's length is unsure", sut.reason().c_str());
  }
}

TEST(Bound, ALineOfAnArmThatMovesTooMuchIsNone) {
  const test::MadePair pair = test::last_pair({.seed = 700, .difference_rms_mm = 0.12, .feather_seen = true});
  TransferOptions options;
  const double sigma_mm = 0.45;  // U95 is 2.45 of it
  options.upper_scan.arm = uncertainty::ArmMotion{
      .sigma_mm = sigma_mm, .profiles = 1, .places = {{.middle_base = Vec3::Zero(), .sigma_mm = sigma_mm}}};
  const Transfer sut =
      transfer_line({.cloud = pair.sample_cloud, .line = pair.sample_line}, pair.upper_cloud, options);
  CHECK_FALSE(sut.found);
  CHECK(sut.refusal->code == Refused::TooMuchUnsure);
  CHECK_COMPARE(sut.bound_mm, >, cloud::k_sure_mm);
}

}  // namespace biteline::transfer
