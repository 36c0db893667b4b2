// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "hal/sim/shoe/outline.hpp"
#include "host/bite_line/shoe/plan_shape.hpp"

namespace biteline::bite_line {

TEST_GROUP(PlanShape){};

TEST(PlanShape, AnEllipseIsBroadestInTheMiddle) {
  std::vector<Vec2> curve;
  for (int i = 0; i < 720; ++i) {
    const double angle = i * std::numbers::pi / 360;
    curve.push_back({150 * std::cos(angle), 50 * std::sin(angle)});
  }
  const PlanShape sut = plan_shape(Outline{curve, {}});
  DOUBLES_EQUAL(0.5, sut.broadest_at, 0.01);
  DOUBLES_EQUAL(1.0 / 3, sut.breadth_to_length, 0.01);
  // At a share t of the length an ellipse is 2 sqrt(t - t^2) of its breadth; the outline's own smoothing and
  // the slices of half a hundredth make 0.03.
  for (std::size_t i = 1; i + 1 < sut.breadth.size(); ++i) {
    const double t = PlanShape::k_at[i];
    DOUBLES_EQUAL(2 * std::sqrt(t - t * t), sut.breadth[i], 0.03);
  }
}

TEST(PlanShape, AMadeShoeIsBroadestAtTheBall) {
  for (const bool left : {false, true}) {
    const sim::Outline shoe{{.length_mm = 290, .left_foot = left}};
    std::vector<Vec2> curve;
    for (int i = 0; i < 800; ++i) curve.push_back(shoe.at(shoe.perimeter_mm() * i / 800).point);
    const PlanShape sut = plan_shape(Outline{convex_hull(curve), {}});
    DOUBLES_EQUAL(0.70, sut.broadest_at, 0.03);
    CHECK(sut.breadth.front() < 0.6 && sut.breadth.back() < 0.6);
    CHECK(sut.breadth[1] < sut.breadth[7]);
  }
}

}  // namespace biteline::bite_line
