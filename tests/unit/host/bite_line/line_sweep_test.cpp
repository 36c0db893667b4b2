// SPDX-License-Identifier: MIT
#include "tests/support/line_sweep.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/live_scan.hpp"

namespace biteline::test {

namespace {

Vec3 place(int i) {
  const double angle = i * 2 * M_PI / 1200;
  return {600 / (2 * M_PI) * std::cos(angle), 600 / (2 * M_PI) * std::sin(angle), 0};
}

cloud::LinePoint point(const Vec3& position, double confidence) {
  return {.position = position, .normal = Vec3::UnitX(), .tangent = Vec3::UnitX(), .confidence = confidence};
}

/// A ring of 600 mm, as a truth ...
SweepScan ring() {
  SweepScan scan;
  for (int i = 0; i < 1200; ++i) scan.truth.points.push_back(point(place(i), 1));
  return scan;
}

/// ... and as a line that leaves it by `off_mm` over its first `bad_mm`.
bite_line::Extraction line(double off_mm, double bad_mm, double confidence) {
  bite_line::Extraction found;
  found.found = true;
  for (int i = 0; i < 1200; ++i) {
    const bool bad = i * 0.5 < bad_mm;
    const Vec3 off = (bad ? off_mm : 0.0) * Vec3::UnitZ();
    found.line.points.push_back(point(place(i) + off, bad ? confidence : 0.99));
  }
  return found;
}

}  // namespace

TEST_GROUP(LineSweep){};

TEST(LineSweep, TheMaterialHasItsSayAlsoWhileScanning) {
  // A sole that is nearly flush: another crease of its own is about as good as its line.
  SweepCell cell = sweep_cell(41'001, 12);
  cell.fault = CloudFault::None;
  cell.crease_ratio = 0.2;
  cell.stripe = true;
  SweepScan scan = scan_of(cell);
  const bite_line::Extraction with = bite_line::find_bite_line(scan.cloud, {});
  const auto scanned = [&](bool backwards) {
    const auto& profile = scan.cloud.profile;
    std::vector<std::pair<std::size_t, std::size_t>> ranges;
    for (std::size_t first = 0; first < profile.size(); first += ranges.back().second) {
      std::size_t count = 1;
      while (first + count < profile.size() && profile[first + count] == profile[first]) ++count;
      ranges.emplace_back(first, count);
    }
    if (backwards) std::ranges::reverse(ranges);
    bite_line::LiveScan live;
    for (const auto& [first, count] : ranges)
      live.add_profile(profile[first], {scan.cloud.points.data() + first, count}, {},
                       scan.cloud.stripe(first, count));
    return live.finish({});
  };
  const double forwards = scanned(false).confidence;
  DOUBLES_EQUAL(forwards, scanned(true).confidence, 0);
  DOUBLES_EQUAL(with.confidence, forwards, 0.01);  // a live scan counts the arm's sway in
  scan.cloud.amplitude.clear();
  scan.cloud.width_px.clear();
  CHECK_COMPARE(std::abs(bite_line::find_bite_line(scan.cloud, {}).confidence - with.confidence), >, 0.2);
}

TEST(LineSweep, ALineIsWrongWhereMoreThanFiveMillimetresAreOffWithoutAWord) {
  CHECK(judge(ring(), line(1.2, 8, 0.9)).judged == Judged::Wrong);
  CHECK(judge(ring(), line(1.2, 4, 0.9)).judged == Judged::Right);
  CHECK(judge(ring(), line(0.8, 300, 0.9)).judged == Judged::Right);
}

TEST(LineSweep, WhatIsFlaggedIsNoWrongLine) {
  CHECK(judge(ring(), line(5, 50, 0.4)).judged == Judged::Right);
  DOUBLES_EQUAL(50.0 / 600, judge(ring(), line(5, 50, 0.4)).flagged_share, 1e-3);
  bite_line::Extraction found = line(5, 50, 0.9);
  for (int i = 0; i < 100; ++i) found.line.points[static_cast<std::size_t>(i)].u95_mm = 1.5;
  CHECK(judge(ring(), found).judged == Judged::Right);
}

TEST(LineSweep, AnyLineIsWrongWhereThereIsNone) {
  CHECK(judge({}, line(0, 0, 0.9)).judged == Judged::Wrong);
  CHECK(judge({}, {}).judged == Judged::Right);
  CHECK(judge(ring(), {}).judged == Judged::Refused);
}

TEST(LineSweep, TheBoundIsClopperAndPearsons) {
  // None among n: 1 - 0.05^(1/n).
  DOUBLES_EQUAL(1 - std::pow(0.05, 1.0 / 3000), upper_bound_95(0, 3000), 1e-9);
  // 1 of 10, from tables of the one-sided limit.
  DOUBLES_EQUAL(0.3942, upper_bound_95(1, 10), 1e-4);
}

TEST(LineSweep, ACellMakesTheSameScanAgainAndFaultsMoveTheTruthAlong) {
  SweepCell cell{.shoe = {.shoe_class = sim::ShoeClass::Pump, .decoy = sim::Decoy::Logo},
                 .fault = CloudFault::Mirrored,
                 .seed = 4};
  const SweepScan a = scan_of(cell);
  const SweepScan b = scan_of(cell);
  CHECK(a.cloud.points == b.cloud.points);
  // The truth lies on the points still: half a profile's step, a column's and the noise apart at most.
  for (std::size_t i = 0; i < a.truth.points.size(); i += 40) {
    float nearest = 1e9F;
    for (const Eigen::Vector3f& p : a.cloud.points)
      nearest = std::min(nearest, (p - a.truth.points[i].position.cast<float>()).norm());
    CHECK(nearest < 0.7F);
  }
}

TEST(LineSweep, CountersCapsAndSecondLedgesDoNotDrawTheLineAndThingsHaveNone) {
  // Counters, a cap, a second ledge, and a dish, of the first sweep.
  for (const std::uint64_t index : {4U, 6U, 560U, 726U, 787U, 55U}) {
    const SweepScan scan = scan_of(sweep_cell(1, index));
    CHECK(judge(scan, bite_line::find_bite_line(scan.cloud, {})).judged == Judged::Right);
  }
}

TEST(LineSweep, ABridgeRoundAnEndOwnsUpToHowSharpTheEndMayBe) {
  // Heels of children's shoes, all gone, of the third sweep.
  for (const std::uint64_t index : {19U, 288U, 323U}) {
    const SweepScan scan = scan_of(sweep_cell(3, index));
    CHECK(judge(scan, bite_line::find_bite_line(scan.cloud, {})).judged != Judged::Wrong);
  }
}

TEST(LineSweep, AFilledCreaseThatJumpsBetweenFewPointsIsUnsure) {
  // Wide sections take the places beside a jump in: 5 to 9 mm were off by up to 1.5 mm without a word.
  for (const std::uint64_t index : {21347U, 118921U, 124394U}) {
    const SweepScan scan = scan_of(sweep_cell(164001, index));
    CHECK(judge(scan, bite_line::find_bite_line(scan.cloud, {})).judged != Judged::Wrong);
  }
}

TEST(LineSweep, AMeanOverFewSectionsThatWereSeenSaysHowLittleItKnows) {
  // Few points on a welt: 6.5 mm were up to 1.1 mm off, 0.7 mm was stated.
  const SweepScan scan = scan_of(sweep_cell(157001, 394));
  CHECK(judge(scan, bite_line::find_bite_line(scan.cloud, {})).judged != Judged::Wrong);
}

}  // namespace biteline::test
