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

TEST(Cells, AreCountedAndAveragedInTheirOrderHoweverOftenTheCloudComesBack) {
  // Two places, taken in turn: each is several runs of its cell.
  std::vector<Eigen::Vector3f> points;
  for (int round = 0; round < 100; ++round) {
    for (const float x_mm : {30.0F, 0.0F}) {
      points.emplace_back(x_mm, 0.0F, 0.0F);
      points.emplace_back(x_mm + 1, 0.0F, 0.5F);
    }
  }
  const Cells sut{points, {}};
  std::size_t counted = 0;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t slot = 0; slot < sut.occupied().size(); ++slot) {
    if (slot > 0) CHECK(sut.occupied()[slot - 1] < sut.occupied()[slot]);
    counted += sut.counts()[slot];
    sum += static_cast<float>(sut.counts()[slot]) * sut.means()[slot];
  }
  LONGS_EQUAL(points.size(), counted);
  DOUBLES_EQUAL(15.5, sum.x() / static_cast<float>(counted), 1e-3);
  DOUBLES_EQUAL(0.25, sum.z() / static_cast<float>(counted), 1e-3);
  const std::size_t slot = sut.slot(sut.cell_of(0));
  CHECK(sut.means()[slot].x() > 29 && sut.counts()[slot] >= 100);
}

}  // namespace biteline::bite_line
