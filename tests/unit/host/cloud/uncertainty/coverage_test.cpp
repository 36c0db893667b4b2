// SPDX-License-Identifier: MIT
// U95 against the truth on a few shoes, each with a head of its own.  The whole table: bench_line_u95.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/made_cloud.hpp"
#include "tests/support/uncertain_scan.hpp"

namespace biteline::uncertainty {
namespace {

struct Held {
  double share{0};
  double mean_u95_mm{0};
  double p95_error_mm{0};
};

Held held_of(int shoes, double errors) {
  double within = 0, u95_sum_mm = 0;
  std::vector<double> errors_mm;
  for (int i = 0; i < shoes; ++i) {
    const test::UncertainScan scan = test::uncertain_scan({.shoe_class = static_cast<sim::ShoeClass>(i % 9),
                                                           .seed = 900 + static_cast<std::uint64_t>(i),
                                                           .profile_step_mm = 1.3,
                                                           .errors = errors});
    const bite_line::Extraction found = test::line_of(scan);
    CHECK_TEXT(found.found, found.reason().c_str());
    CHECK(found.head_in_u95);
    std::vector<Vec3> truth;
    for (const cloud::LinePoint& p : scan.truth.points) truth.push_back(p.position);
    for (std::size_t k = 0; k < found.line.points.size(); k += 5) {
      const cloud::LinePoint& p = found.line.points[k];
      errors_mm.push_back(test::distance_mm(p.position, truth));
      within += errors_mm.back() <= p.u95_mm.value_or(0) ? 1 : 0;
      u95_sum_mm += p.u95_mm.value_or(0);
    }
  }
  const auto count = static_cast<double>(errors_mm.size());
  std::sort(errors_mm.begin(), errors_mm.end());
  return {.share = within / count,
          .mean_u95_mm = u95_sum_mm / count,
          .p95_error_mm = errors_mm[static_cast<std::size_t>(0.95 * (count - 1))]};
}

}  // namespace

TEST_GROUP(Coverage){};

TEST(Coverage, HoldsNineteenPointsOfTwenty) {
  // A shoe's points are off together: a shoe is one draw, and the share scatters at most as a coin that falls
  // right 19 times of 20.
  constexpr int k_shoes = 18;
  const Held sut = held_of(k_shoes, 1);
  CHECK_COMPARE(sut.share, >=, 0.95 - 2 * std::sqrt(0.95 * 0.05 / k_shoes));
  // Nothing is held by saying little: no more than twice what 18 draws show.
  CHECK_COMPARE(sut.mean_u95_mm, <=, 2 * sut.p95_error_mm);
}

TEST(Coverage, AnExactHeadLeavesTheNoise) {
  const Held sut = held_of(6, 0);
  CHECK_COMPARE(sut.share, >=, 0.90);
  CHECK_COMPARE(sut.mean_u95_mm, <=, 0.08);  // the line's own right is 0.05 mm
}

}  // namespace biteline::uncertainty
