// SPDX-License-Identifier: MIT
#include "host/transfer/align/smooth_field.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace biteline::transfer {
namespace {

constexpr double k_ring_mm = 600, k_high_mm = 48;

/// A wall that one wave of 0.3 mm moves outwards, alike at all heights.  From 36 mm on it bends over: a fifth
/// of what moves outwards is across it there.
std::vector<FieldProblem::Row> rows_of(bool bend_known) {
  std::vector<FieldProblem::Row> rows;
  for (double along_mm = 3; along_mm < k_ring_mm; along_mm += 6) {
    const double turn_rad = 2 * std::numbers::pi * along_mm / k_ring_mm;
    for (double across_mm = 3; across_mm < k_high_mm; across_mm += 6) {
      const double level = across_mm > 36 ? 0.2 : 1;
      const double rise = std::sqrt(1 - level * level);
      MotionRow jacobian = MotionRow::Zero();
      jacobian.head<3>() = Eigen::Vector3d{level * std::cos(turn_rad), level * std::sin(turn_rad), rise};
      rows.push_back({.along_mm = along_mm,
                      .across_mm = across_mm,
                      .jacobian = jacobian,
                      .difference_mm = level * 0.3 * std::sin(6 * turn_rad),
                      .weight = 1,
                      .share = bend_known ? level : 1});
    }
  }
  return rows;
}

FieldProblem::Reduced reduced(bool bend_known) {
  const std::vector<FieldProblem::Row> rows = rows_of(bend_known);
  const FieldWaves waves{{.ring_mm = k_ring_mm, .low_mm = 0, .high_mm = k_high_mm, .shortest_mm = 60}};
  // As strong as it is, against noise of 0.04 mm; alike over all heights.
  const double strength = std::pow(0.2 / 0.04, 2);
  return FieldProblem{waves, rows}.reduced(strength * waves.variances({.along_mm = 45, .across_mm = 200}));
}

}  // namespace

TEST_GROUP(SmoothField){};

TEST(SmoothField, AWallThatBendsOverShowsAShareOfWhatMovesItOutwards) {
  // What the field does not explain, over the noise's variance: noise would leave one for each row.
  const double noise_mm2 = 0.04 * 0.04;
  const double left = reduced(true).squares / noise_mm2, taken_alike = reduced(false).squares / noise_mm2;
  const double rows = static_cast<double>(rows_of(true).size());
  CHECK(left < rows);
  CHECK(taken_alike > 2 * rows);
}

}  // namespace biteline::transfer
