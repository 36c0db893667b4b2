// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <vector>

#include "host/bite_line/place/place_along.hpp"
#include "host/bite_line/place/straightened.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "tests/unit/host/bite_line/guard_shoes.hpp"

namespace biteline::test {

namespace {

/// Once round at a height, but for a stretch that goes straight up, along and straight down again.
std::vector<Vec2> gate(double length_mm, double low_mm, double high_mm) {
  constexpr double k_from_mm = 100, k_to_mm = 130, k_step_mm = 0.5;
  std::vector<Vec2> guide;
  for (double s = 0; s < k_from_mm; s += k_step_mm) guide.emplace_back(s, low_mm);
  for (double z = low_mm; z < high_mm; z += k_step_mm) guide.emplace_back(k_from_mm, z);
  for (double s = k_from_mm; s < k_to_mm; s += k_step_mm) guide.emplace_back(s, high_mm);
  for (double z = high_mm; z > low_mm; z -= k_step_mm) guide.emplace_back(k_to_mm, z);
  for (double s = k_to_mm; s < length_mm - k_step_mm / 2; s += k_step_mm) guide.emplace_back(s, low_mm);
  return guide;
}

}  // namespace

TEST_GROUP(Straightened){};

TEST(Straightened, WhatIsLevelledAndBroughtBackLiesWhereItWas) {
  const bite_line::Side side = side_of(scan_of(with_guard(designed(0))));
  const auto straightened = bite_line::Straightened::along(side, gate(side.outline.length_mm(), 25, 40));
  CHECK(straightened.has_value());
  const bite_line::Shoe level = straightened->shoe();
  CHECK(level.points.size() > side.shoe.points.size() / 2);
  std::vector<float> off_mm;
  for (std::size_t i = 0; i < level.points.size(); i += 50) {
    const auto own = std::lower_bound(side.shoe.index.begin(), side.shoe.index.end(), level.index[i]);
    const Eigen::Vector3f& was = side.shoe.points[static_cast<std::size_t>(own - side.shoe.index.begin())];
    off_mm.push_back((straightened->back(level.points[i].cast<double>()).cast<float>() - was).norm());
  }
  // What lies in the fold of a corner has no place of its own: a part of the two corners' 40 mm.
  std::ranges::sort(off_mm);
  CHECK_TEXT(off_mm[off_mm.size() * 9 / 10] < 0.03F, "nine of ten within the outline's own interpolation");
}

TEST(Straightened, ABridgeIsAsUnsureAsItsGuideIsOffAtItsEnds) {
  // A gap of ten stations: its guide is off by 1 mm where it ends, and right where it begins.
  bite_line::PlacedLine placed;
  placed.points.resize(100);
  for (std::size_t i = 0; i < 100; ++i) {
    placed.points[i].own_z_mm = i == 60 ? 11.0 : 10.0;
    placed.points[i].to_visible_mm = i > 50 && i < 60 ? 1.0 : 0.0;
  }
  bite_line::doubt_guide_in_gaps(10.0, placed);
  for (std::size_t k = 0; k <= 10; ++k) {
    const double in_gap_mm = k < 10 ? 0.1 * static_cast<double>(k) : 0.0;
    DOUBLES_EQUAL(in_gap_mm, placed.points[50 + k].between_up_mm, 1e-12);
  }
  DOUBLES_EQUAL(0, placed.points[20].between_up_mm, 1e-12);
}

TEST(Straightened, TheGuideRunsLevelAtItsMeanHeight) {
  const bite_line::Side side = side_of(scan_of(with_guard(designed(0))));
  const std::vector<Vec2> guide = gate(side.outline.length_mm(), 25, 40);
  const auto straightened = bite_line::Straightened::along(side, guide);
  CHECK(straightened.has_value());
  double mean_mm = 0;
  for (const Vec2& place : guide) mean_mm += place.y() / static_cast<double>(guide.size());
  // Up one flank: 8 mm above the foot, and clear of the smoothed corners.
  const Vec2 plan = side.outline.point(100);
  const Vec3 at = side.shoe.T_base_shoe * Vec3{plan.x(), plan.y(), 33};
  const Eigen::Vector3f up = straightened->points(std::vector<Eigen::Vector3f>{at.cast<float>()}).front();
  DOUBLES_EQUAL(mean_mm, static_cast<double>(up.z()), 0.3);
}

}  // namespace biteline::test
