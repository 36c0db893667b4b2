// SPDX-License-Identifier: MIT
#include "host/second_look/faults.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

namespace biteline::second_look {
namespace {

constexpr double k_radius_mm = 100;

cloud::ClosedLine circle() {
  cloud::ClosedLine line;
  for (int i = 0; i < 720; ++i) {
    const double at_rad = 2 * std::numbers::pi * i / 720;
    const Vec3 out{std::cos(at_rad), std::sin(at_rad), 0};
    line.points.push_back(
        {.position = k_radius_mm * out, .normal = out, .tangent = Vec3::Zero(), .confidence = 1});
  }
  return line;
}

}  // namespace

TEST_GROUP(JoinFaults) {
  LineFrame frame{circle()};
  SurfaceWays ways{{}, frame, 10};
  std::vector<double> along_mm{};
  std::vector<std::uint8_t> blank{};
  SeenAt seen{};

  void setup() override {
    for (double mm = 0; mm < frame.length_mm() - 0.5; mm += 1) along_mm.push_back(mm);
    blank.assign(along_mm.size(), 0);
    seen.resize(along_mm.size());
  }
  std::vector<Fault> joined() {
    return join_faults(seen, {.along_mm = along_mm, .blank = blank, .line_mm = frame.length_mm()}, frame,
                       ways);
  }
  void see(std::size_t row, FaultKind kind = FaultKind::Missing) {
    seen[row].push_back({.kind = kind, .low_mm = 0, .high_mm = 8});
  }
};

TEST(JoinFaults, RowsInARowAreOneFaultFromMiddleToMiddle) {
  for (std::size_t i = 50; i < 55; ++i) see(i);
  const auto faults = joined();
  LONGS_EQUAL(1, faults.size());
  DOUBLES_EQUAL(49.5, faults[0].along.from_mm, 1e-9);
  DOUBLES_EQUAL(54.5, faults[0].along.to_mm, 1e-9);
}

TEST(JoinFaults, OverTheFirstRowIsOneFault) {
  see(0), see(1), see(along_mm.size() - 1), see(along_mm.size() - 2);
  const auto faults = joined();
  LONGS_EQUAL(1, faults.size());
  CHECK(faults[0].along.from_mm > faults[0].along.to_mm);
}

TEST(JoinFaults, OneProfileAloneTellsNothing) {
  see(50);
  LONGS_EQUAL(0, joined().size());
}

TEST(JoinFaults, ARowWithoutPointsIsAsThoseBesideIt) {
  see(50), see(52);
  blank[51] = 1;
  LONGS_EQUAL(1, joined().size());
}

TEST(JoinFaults, KindsStayApart) {
  for (std::size_t i = 50; i < 53; ++i) see(i), see(i, FaultKind::Doubled);
  LONGS_EQUAL(2, joined().size());
}

TEST(JoinFaults, AllRoundIsTheWholeLine) {
  for (std::size_t i = 0; i < seen.size(); ++i) see(i);
  const auto faults = joined();
  LONGS_EQUAL(1, faults.size());
  DOUBLES_EQUAL(frame.length_mm(), faults[0].along.to_mm, 1e-9);
}

TEST_GROUP(LineFrameOfACircle) {
  LineFrame sut{circle()};
};

TEST(LineFrameOfACircle, OutIsOutAndUpIsUp) {
  LineFrame::Place place;
  CHECK_TRUE(sut.place({0, 103, 4}, 10, place));
  DOUBLES_EQUAL(3, place.out_mm, 0.01);
  DOUBLES_EQUAL(4, place.up_mm, 0.01);
  DOUBLES_EQUAL(sut.length_mm() / 4, static_cast<double>(place.station) * sut.step_mm(), k_station_mm);
}

TEST(LineFrameOfACircle, FarPointsLieNowhere) {
  LineFrame::Place place;
  CHECK_FALSE(sut.place({0, 115, 0}, 10, place));
  CHECK_FALSE(sut.place({1000, 0, 0}, 10, place));
}

}  // namespace biteline::second_look
