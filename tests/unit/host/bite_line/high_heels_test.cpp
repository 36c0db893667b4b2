// SPDX-License-Identifier: MIT
// Pumps whose line at the heel lies as high as a low shoe's collar and higher.
#include <CppUTest/TestHarness.h>

#include <cstdint>
#include <initializer_list>

#include "host/bite_line/find_bite_line.hpp"
#include "tests/support/line_sweep.hpp"

namespace biteline::test {

namespace {

/// A pump of a full-size shoe's length with its line lifted at the heel by so much of that.
Judged judged_with_heel(std::uint64_t seed, double heel_ratio) {
  SweepCell cell;
  cell.seed = seed;
  cell.shoe.shoe_class = sim::ShoeClass::Pump;
  cell.shoe.length_mm = 265;
  cell.shoe.heel_ratio = heel_ratio;
  const SweepScan scan = scan_of(cell);
  return judge(scan, bite_line::find_bite_line(scan.cloud, {})).judged;
}

int found_with_heel(std::initializer_list<std::uint64_t> seeds, double heel_ratio) {
  int found = 0;
  for (const std::uint64_t seed : seeds) {
    const Judged judged = judged_with_heel(seed, heel_ratio);
    CHECK(judged != Judged::Wrong);
    found += judged == Judged::Right ? 1 : 0;
  }
  return found;
}

}  // namespace

TEST_GROUP(HighHeels){};

TEST(HighHeels, OfEightyMillimetresHaveTheirLine) {
  LONGS_EQUAL(4, found_with_heel({1, 2, 3, 4}, 0.3));
}

TEST(HighHeels, ThatClimbByMoreThan45DegreesHaveTheirLineOrAreRefused) {
  // The shank climbs by up to 50 degrees.
  CHECK(found_with_heel({1, 2, 3, 4}, 0.37) >= 2);
}

TEST(HighHeels, ThatLieBesideTheirShankAreFlaggedThere) {
  // Its line was wrong without a word over 17 mm: the place was doubted, and its U95 did not say so.
  SweepCell cell = sweep_cell(30113014, 188);
  cell.shoe.heel_ratio = 0.4;
  const SweepScan scan = scan_of(cell);
  CHECK(judge(scan, bite_line::find_bite_line(scan.cloud, {})).judged != Judged::Wrong);
}

}  // namespace biteline::test
