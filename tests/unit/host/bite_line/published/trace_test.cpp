// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/bite_line/published/thin.hpp"
#include "host/bite_line/published/trace.hpp"

namespace biteline::published {
namespace {

Unrolled blank() {
  Unrolled picture;
  picture.rows = 60;
  picture.cols = 300;
  picture.row_mm = 0.5;
  picture.col_mm = 1.0;
  picture.top_mm = 40;
  picture.value.assign(60 * 300, 0.0F);
  picture.known.assign(60 * 300, 1);
  return picture;
}

void draw(Unrolled& picture, int row, int col) {
  picture.value[picture.at(row, col)] = -0.4F;
}

int wave(int col) {
  return 30 + static_cast<int>(std::lround(6 * std::sin(2 * std::numbers::pi * col / 300)));
}

}  // namespace

TEST_GROUP(Published) {
  Unrolled picture = blank();
};

TEST(Published, AWavyGrooveIsTracedFromEndToEndAndCloses) {
  for (int c = 0; c < 300; ++c) {
    for (int d = -1; d <= 1; ++d) draw(picture, wave(c) + d, c);
  }
  const TracedLine sut = join_segments(picture, trace_segments(picture, {}), {});
  CHECK_FALSE(sut.refusal.has_value());
  for (int c = 0; c < 300; ++c) DOUBLES_EQUAL(wave(c), sut.path_row[static_cast<std::size_t>(c)], 1.6);
}

TEST(Published, AShortGapIsJoined) {
  for (int c = 0; c < 300; ++c) {
    if (c < 100 || c > 120) draw(picture, wave(c), c);
  }
  const TracedLine sut = join_segments(picture, trace_segments(picture, {}), {});
  CHECK_FALSE(sut.refusal.has_value());
  CHECK(sut.covered_ratio < 0.95);
}

TEST(Published, AForkEndsASegment) {
  for (int c = 0; c < 300; ++c) {
    draw(picture, 30, c);
    // Three branches within the rectangle's width ahead of column 150 look round, not long.
    if (c > 150 && c < 156) {
      for (int r = 26; r <= 34; ++r) draw(picture, r, c);
    }
  }
  std::vector<Segment> sut = trace_segments(picture, {.shortest_px = 3});
  CHECK(sut.size() >= 2);
}

TEST(Published, ALineThatEndsHigherThanItBeganDoesNotClose) {
  for (int c = 0; c < 300; ++c) draw(picture, 20 + c / 20, c);
  const TracedLine sut = join_segments(picture, trace_segments(picture, {}), {});
  CHECK(sut.refusal.has_value());
  STRCMP_CONTAINS("does not close", sut.refusal->reason.c_str());
  DOUBLES_EQUAL(7.0, sut.closure_mm, 0.6);
}

TEST(Published, HalfALineIsNotTheWholeWay) {
  for (int c = 40; c < 190; ++c) draw(picture, 30, c);
  const TracedLine sut = join_segments(picture, trace_segments(picture, {}), {});
  CHECK(sut.refusal.has_value());
  STRCMP_CONTAINS("from 40 to 189", sut.refusal->reason.c_str());
}

TEST(Published, ThinningPullsALevelThickLineOntoItsMiddle) {
  // Level, where x = m z + x0 has no answer.
  std::mt19937 random{2};
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  const int count = 3000;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * std::numbers::pi * i / count;
    const double r = 100 + 0.5 * normal(random);
    points.emplace_back(r * std::cos(a), r * std::sin(a), 25 + 0.5 * normal(random));
  }
  const std::vector<Vec3> sut = thin(points, {.lambda = 15, .rounds = 2});
  double before = 0;
  double after = 0;
  for (int i = 0; i < count; ++i) {
    const auto off = [](const Vec3& p) {
      return std::pow(p.head<2>().norm() - 100, 2) + std::pow(p.z() - 25, 2);
    };
    before += off(points[static_cast<std::size_t>(i)]) / count;
    after += off(sut[static_cast<std::size_t>(i)]) / count;
  }
  CHECK(std::sqrt(after) < 0.35 * std::sqrt(before));
}

TEST(Published, SectionsMeetWithoutAJumpAndRunOnceRound) {
  const EightSections sut{{.length_mm = 290, .half_width_mm = 50}};
  double last = -1;
  double turned = 0;
  for (int i = 0; i < 3600; ++i) {
    // Anticlockwise round the middle, beginning at corner A.
    const double a = std::atan2(50.0, 0.85 * 290 - 145) + 2 * std::numbers::pi * i / 3600;
    const Vec2 p{145 + 140 * std::cos(a), 48 * std::sin(a)};
    const double along = sut.along_mm(p.x(), p.y());
    CHECK(along >= 0 && along <= sut.perimeter_mm());
    if (last >= 0) {
      double step = along - last;
      if (step < -0.5 * sut.perimeter_mm()) step += sut.perimeter_mm();
      CHECK(step > -0.01 && step < 12);
      turned += step;
    }
    last = along;
  }
  DOUBLES_EQUAL(sut.perimeter_mm(), turned, 2.0);
}

}  // namespace biteline::published
