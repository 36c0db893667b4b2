// SPDX-License-Identifier: MIT
#include "host/bite_line/shoe/cells.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace biteline::bite_line {

namespace {

/// Points in a level row of cells.
void add_row(float x_mm, float length_mm, float y_mm, std::vector<Eigen::Vector3f>& points) {
  for (float at = 0; at <= length_mm; at += 1) points.emplace_back(x_mm + at, y_mm, 1.0F);
}

}  // namespace

TEST_GROUP(Cells){};

TEST(Cells, PartsThatMeetLateAreOneAndCountFromTheFirstCell) {
  // A comb, whose teeth meet in its last row, and a row apart from it.
  std::vector<Eigen::Vector3f> points;
  for (const float x_mm : {0.0F, 40.0F, 80.0F}) {
    for (float y_mm = 0; y_mm <= 40; y_mm += 1) points.emplace_back(x_mm, y_mm, 1.0F);
  }
  add_row(0, 80, 40, points);
  add_row(0, 80, 70, points);
  const Cells sut{points, {}};
  std::vector<std::int32_t> labels;
  LONGS_EQUAL(2, sut.label(std::vector<bool>(sut.occupied().size(), true), labels));
  for (std::size_t i = 0; i < points.size(); ++i)
    LONGS_EQUAL(points[i].y() > 50 ? 1 : 0, labels[sut.slot(sut.cell_of(i))]);
}

TEST(Cells, WhatIsNotKeptNeitherHasALabelNorJoins) {
  std::vector<Eigen::Vector3f> points;
  add_row(0, 60, 0, points);
  const Cells sut{points, {}};
  std::vector<bool> keep(sut.occupied().size(), true);
  const std::size_t middle = keep.size() / 2;
  keep[middle] = false;
  std::vector<std::int32_t> labels;
  LONGS_EQUAL(2, sut.label(keep, labels));
  LONGS_EQUAL(-1, labels[middle]);
  LONGS_EQUAL(0, labels.front());
  LONGS_EQUAL(1, labels.back());
}

}  // namespace biteline::bite_line
