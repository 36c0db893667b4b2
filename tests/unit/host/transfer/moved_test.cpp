// SPDX-License-Identifier: MIT
#include "host/transfer/moved.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <functional>

#include "tests/support/uncertain_scan.hpp"

namespace biteline::transfer {
namespace {

using Told = Moved::Verdict;

constexpr double k_nudge_mm = 0.3;

/// A shoe, scanned and looked at again by an arm that does not quite repeat its way.
struct TwoScans {
  test::UncertainScanSettings settings{.shoe_class = sim::ShoeClass::Deep, .seed = 7001};
  test::UncertainScan held{test::uncertain_scan(settings)};
  std::vector<Vec3> line{};
  cloud::PointCloud look{};
  Vec3 middle{Vec3::Zero()}, along{Vec3::UnitX()}, across{Vec3::UnitY()};  ///< of the shoe, level

  TwoScans() {
    for (const cloud::LinePoint& p : held.truth.points) line.push_back(p.position);
    look = again(0);
    for (const Vec3& p : line) middle += p / static_cast<double>(line.size());
    const Vec3 toe = *std::ranges::max_element(line, {}, [&](const Vec3& p) { return (p - middle).norm(); });
    along = Vec3{toe.x() - middle.x(), toe.y() - middle.y(), 0}.normalized();
    across = Vec3::UnitZ().cross(along);
  }
  [[nodiscard]] cloud::PointCloud again(double last_difference_mm) const {
    test::UncertainScanSettings second = settings;
    second.again = 5;
    second.last_difference_mm = last_difference_mm;
    return test::uncertain_scan(second).cloud;
  }
  [[nodiscard]] double farthest_mm() const {
    double most = 0;
    for (const Vec3& p : line) most = std::max(most, (p - middle).head<2>().norm());
    return most;
  }
};

const TwoScans& scans() {
  static const TwoScans k_scans;
  return k_scans;
}

cloud::PointCloud changed(cloud::PointCloud cloud, const std::function<Vec3(const Vec3&)>& change) {
  for (Eigen::Vector3f& p : cloud.points) p = change(p.cast<double>()).cast<float>();
  return cloud;
}

cloud::PointCloud shifted(const cloud::PointCloud& cloud, const Vec3& by_mm) {
  return changed(cloud, [&](const Vec3& p) -> Vec3 { return p + by_mm; });
}

cloud::PointCloud turned(const cloud::PointCloud& cloud, const Vec3& axis, double by_rad) {
  const Eigen::AngleAxisd turn{by_rad, axis};
  return changed(cloud, [&](const Vec3& p) -> Vec3 { return scans().middle + turn * (p - scans().middle); });
}

/// Of the way round.
cloud::PointCloud part(const cloud::PointCloud& cloud, double from, double to) {
  cloud::PointCloud out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double share = static_cast<double>(cloud.profile[i]) / cloud.profile.back();
    if (share >= from && share <= to) out.points.push_back(cloud.points[i]);
  }
  return out;
}

/// A table below the shoe, and a post of the fixture beside it.
void add_what_stays(cloud::PointCloud& cloud, float grain_mm) {
  float lowest = 1e9F;
  for (const Eigen::Vector3f& p : cloud.points) lowest = std::min(lowest, p.z());
  const Vec3 post = scans().middle + 80 * scans().across;
  for (float x = -250; x < 250; x += grain_mm) {
    for (float y = -250; y < 250; y += grain_mm)
      cloud.points.emplace_back(scans().middle.x() + x, scans().middle.y() + y, lowest);
  }
  for (float u = -40; u < 40; u += grain_mm) {
    for (float z = 0; z < 80; z += grain_mm)
      cloud.points.push_back((post + static_cast<double>(u) * scans().along).cast<float>() +
                             Eigen::Vector3f{0, 0, lowest - static_cast<float>(post.z()) + z});
  }
}

Moved judged(const cloud::PointCloud& look) {
  return moved_since(scans().held.cloud, look, scans().line);
}

void is_told(Told verdict, const cloud::PointCloud& look) {
  const Moved moved = judged(look);
  CHECK_TEXT(moved.verdict == verdict, moved.words.c_str());
  CHECK(!moved.words.empty());
}

}  // namespace

TEST_GROUP(MovedSince){};

TEST(MovedSince, AnUntouchedShoeIsUnmoved) {
  const Moved sut = judged(scans().look);
  CHECK_TEXT(sut.verdict == Told::Unmoved, sut.words.c_str());
  CHECK(sut.shift_mm + sut.u95_mm <= k_most_moved_mm);
  DOUBLES_EQUAL(k_most_moved_mm, sut.limit_mm, 0);
}

TEST(MovedSince, ANudgeIsToldInAnyDirection) {
  const TwoScans& s = scans();
  for (const Vec3& direction : {s.along, s.across, Vec3{-s.along}, Vec3{(s.along - s.across).normalized()},
                                Vec3{Vec3::UnitZ()}, Vec3{(s.across - Vec3::UnitZ()).normalized()}}) {
    const Moved sut = judged(shifted(s.look, k_nudge_mm * direction));
    CHECK_TEXT(sut.verdict == Told::Moved, sut.words.c_str());
    DOUBLES_EQUAL(k_nudge_mm, sut.shift_mm, 0.05);
  }
}

TEST(MovedSince, ATurnIsToldByThePlaceThatMovedFarthest) {
  const double turn_rad = k_nudge_mm / scans().farthest_mm();
  for (const Vec3& axis : {Vec3{Vec3::UnitZ()}, Vec3{-Vec3::UnitZ()}, scans().across}) {
    const Moved sut = judged(turned(scans().look, axis, turn_rad));
    CHECK_TEXT(sut.verdict == Told::Moved, sut.words.c_str());
    DOUBLES_EQUAL(k_nudge_mm, sut.shift_mm, 0.06);
  }
}

TEST(MovedSince, AnotherPieceInTheSamePlaceIsAnotherShoe) {
  is_told(Told::OtherShoe, scans().again(0.15));
}

TEST(MovedSince, TheOtherFootIsAnotherShoe) {
  const TwoScans& s = scans();
  is_told(Told::OtherShoe, changed(s.look, [&](const Vec3& p) -> Vec3 {
            return p - 2 * (p - s.middle).dot(s.across) * s.across;
          }));
}

TEST(MovedSince, AShoeThatWasPushedAwayIsTold) {
  for (const double by_mm : {0.5, 2.0, 20.0, 60.0, 300.0}) {
    const Moved sut = judged(shifted(scans().look, by_mm * scans().across));
    CHECK_TEXT(sut.verdict != Told::Unmoved, sut.words.c_str());
  }
}

TEST(MovedSince, APartOfTheShoeWillDo) {
  is_told(Told::Unmoved, part(scans().look, 0, 0.6));
  is_told(Told::Moved, shifted(part(scans().look, 0.3, 1), k_nudge_mm * scans().along));
}

TEST(MovedSince, TooLittleIsNeverUnmoved) {
  is_told(Told::NotSeen, part(scans().look, 0.2, 0.5));
  is_told(Told::NotSeen, part(scans().look, 0, 0.02));
  is_told(Told::NotSeen, {});
  cloud::PointCloud table;
  add_what_stays(table, 1);
  is_told(Told::NotSeen, table);
}

TEST(MovedSince, WhatStaysHasNoSay) {
  cloud::PointCloud held = scans().held.cloud, look = scans().look;
  add_what_stays(held, 0.8F);
  cloud::PointCloud nudged = shifted(look, k_nudge_mm * scans().across);
  add_what_stays(look, 0.7F);
  add_what_stays(nudged, 0.7F);
  CHECK(moved_since(held, look, scans().line).verdict == Told::Unmoved);
  const Moved sut = moved_since(held, nudged, scans().line);
  CHECK_TEXT(sut.verdict == Told::Moved, sut.words.c_str());
  DOUBLES_EQUAL(k_nudge_mm, sut.shift_mm, 0.05);
}

TEST(MovedSince, WithoutALineNothingIsKnown) {
  CHECK(moved_since(scans().held.cloud, scans().look, {}).verdict == Told::NotSeen);
  CHECK(moved_since({}, scans().look, scans().line).verdict == Told::NotSeen);
}

TEST(MovedSince, ALimitBelowWhatALookTellsIsNotMet) {
  CHECK(moved_since(scans().held.cloud, scans().look, scans().line, {.limit_mm = 0.02}).verdict !=
        Told::Unmoved);
}

}  // namespace biteline::transfer
