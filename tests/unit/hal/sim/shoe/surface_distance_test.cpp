// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/surface_distance.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::sim {

TEST_GROUP(SurfaceDistance){};

TEST(SurfaceDistance, IsTheStepAlongTheNormalThatMadeThePoint) {
  const MadeShoe shoe(draw_shoe(ShoeClass::Step, 8));
  const SurfaceDistance sut(shoe);
  for (double s_mm = 1; s_mm < shoe.perimeter_mm(); s_mm += 17) {
    const Section section = shoe.section(s_mm);
    for (double z_mm = 3; z_mm < section.top_z_mm() - 1; z_mm += 4.1) {
      if (std::abs(z_mm - section.line_height_mm()) < 3) continue;  // bends too sharply for the first order
      for (const double away_mm : {-0.05, 0.0, 0.08}) {
        const Vec3 point = section.point(z_mm) + away_mm * shoe.normal(s_mm, z_mm);
        DOUBLES_EQUAL(away_mm, sut.signed_distance_mm(point), 0.003);
      }
    }
  }
}

}  // namespace biteline::sim
