// SPDX-License-Identifier: MIT
// A model's mended line chooses among a later scan's own candidates.
#include "host/bite_line/edit/prior.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/bite_line/find_bite_line.hpp"
#include "tests/support/made_cloud.hpp"

namespace biteline::edit {
namespace {

constexpr sim::ShoeClass k_class = sim::ShoeClass::Mixed;

/// The first of some shoes whose second candidate passes every gate, too. Which one it is, the finder
/// decides.
const Surface& later_scan() {
  static const Surface found = [] {
    for (std::uint64_t seed = 13;; ++seed) {
      Surface scan = std::move(Surface::of(test::made_cloud(k_class, seed, test::somewhere()).cloud).value());
      const auto& paths = scan.decision().paths;
      if (seed == 30 || (paths.size() > 1 && paths[0].passes && paths[1].passes)) return scan;
    }
  }();
  return found;
}

/// A candidate's line as the model has it: a placed model lies some tenths of a millimetre off.
cloud::ClosedLine model_line(std::size_t candidate) {
  cloud::ClosedLine line = later_scan().place(later_scan().decision().paths.at(candidate - 1).row, 1.0);
  for (cloud::LinePoint& point : line.points) point.position.z() += 0.3;
  return line;
}

/// A circle of 100 mm, 0.1 mm known, its first tenth lifted.
cloud::ClosedLine circle(double lifted_mm) {
  constexpr int k_points = 600;
  cloud::ClosedLine line;
  for (int i = 0; i < k_points; ++i) {
    const double at = 2 * 3.14159265358979 * i / k_points;
    cloud::LinePoint point;
    point.normal = {std::cos(at), std::sin(at), 0};
    point.tangent = {-std::sin(at), std::cos(at), 0};
    point.position = 100 * point.normal + Vec3{0, 0, i < k_points / 10 ? lifted_mm : 0.0};
    point.u95_mm = 0.1;
    line.points.push_back(point);
  }
  return line;
}

}  // namespace

TEST_GROUP(Prior){};

TEST(Prior, TheCandidateThatThePersonChoseIsTakenOnALaterScan) {
  CHECK(later_scan().decision().paths.size() > 1);
  LONGS_EQUAL(2, nearest_candidate(later_scan(), model_line(2)));
}

TEST(Prior, TheLineAsFoundStaysWhereItIsTheNearest) {
  LONGS_EQUAL(1, nearest_candidate(later_scan(), model_line(1)));
}

TEST(Prior, ACandidateThatFailsAGateIsNotSaved) {
  const Surface bare =
      std::move(Surface::of(test::made_cloud(sim::ShoeClass::Bare, 1, SE3::Identity()).cloud).value());
  const auto& paths = bare.decision().paths;
  CHECK(!paths.at(1).passes);
  LONGS_EQUAL(1, nearest_candidate(bare, bare.place(paths.at(1).row, 1.0)));
}

TEST(Prior, OnlyALineWithMendedPointsIsAPrior) {
  cloud::ClosedLine line = circle(0);
  CHECK(!is_mended(line));
  line.points[7].source = cloud::PointSource::Mended;
  CHECK(is_mended(line));
}

TEST(Prior, ADifferenceIsWeighedAgainstWhatIsKnownOfBothLinesAndTheirPlace) {
  const OffPrior off = off_prior(circle(0), circle(2), 0.2);
  DOUBLES_EQUAL(2, off.most_mm, 0.001);
  DOUBLES_EQUAL(0.2, off.mean_mm, 0.002);
  // 0.1 and 0.1 of the lines, 1.96 x 0.2 of the place.
  DOUBLES_EQUAL(std::sqrt(0.01 + 0.01 + 0.392 * 0.392), off.u95_mm, 1e-6);
  DOUBLES_EQUAL(2 * 3.14159 * 100 / 10, off.beyond_mm, 0.5);
  DOUBLES_EQUAL(0, off_prior(circle(0), circle(0.3), 0.2).beyond_mm, 0);
  DOUBLES_EQUAL(0, off_prior(circle(0), circle(0), 0).most_mm, 1e-9);
}

}  // namespace biteline::edit
