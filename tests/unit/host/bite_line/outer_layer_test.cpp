// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "host/bite_line/side/outer_layer.hpp"

namespace biteline::bite_line {
namespace {

// Cells without a point of the wall, by chance: one in two hundred may go wrong, one in a thousand behind a
// clear gap.
constexpr double k_by_chance_ratio = 0.005;
constexpr double k_by_chance_behind_gap_ratio = 0.001;

constexpr OuterLayerConfig k_config{.length_mm = 600, .z_low_mm = 0, .height_mm = 60};

struct Wall {
  std::vector<OutlinePlace> places;
  std::mt19937 random{4};
  float any(float low, float high) { return std::uniform_real_distribution<float>{low, high}(random); }
};

}  // namespace

TEST_GROUP(OuterLayer) {
  Wall wall;
};

TEST(OuterLayer, ALiningBehindTheWallGoesAndTheWallStays) {
  for (int i = 0; i < 150000; ++i)
    wall.places.push_back({wall.any(0, 600), wall.any(-0.05F, 0.05F), wall.any(0, 60)});
  const std::size_t outside = wall.places.size();
  for (int i = 0; i < 150000; ++i)
    wall.places.push_back({wall.any(0, 600), wall.any(-3.1F, -2.9F), wall.any(0, 60)});
  keep_outer_layer(wall.places, k_config);
  std::size_t lost = 0;
  std::size_t left = 0;
  for (std::size_t i = 0; i < wall.places.size(); ++i) {
    if (i < outside && wall.places[i].s_mm < 0) ++lost;
    if (i >= outside && wall.places[i].s_mm >= 0) ++left;
  }
  CHECK_COMPARE(static_cast<double>(lost), <, k_by_chance_behind_gap_ratio * static_cast<double>(outside));
  CHECK_COMPARE(static_cast<double>(left), <, k_by_chance_behind_gap_ratio * static_cast<double>(outside));
}

TEST(OuterLayer, ALevelLedgeAndTheUpperBehindItStay) {
  // Sole to z = 25, its top level from o = 0 to -5, the upper from there.
  for (int i = 0; i < 100000; ++i)
    wall.places.push_back({wall.any(0, 600), wall.any(-0.03F, 0.03F), wall.any(0, 25)});
  for (int i = 0; i < 30000; ++i)
    wall.places.push_back({wall.any(0, 600), wall.any(-5, 0), 25 + wall.any(-0.03F, 0.03F)});
  for (int i = 0; i < 100000; ++i)
    wall.places.push_back({wall.any(0, 600), -5 + wall.any(-0.03F, 0.03F), wall.any(25, 60)});
  keep_outer_layer(wall.places, k_config);
  std::size_t lost = 0;
  for (const OutlinePlace& place : wall.places) lost += place.s_mm < 0 ? 1 : 0;
  CHECK_COMPARE(static_cast<double>(lost), <, k_by_chance_ratio * static_cast<double>(wall.places.size()));
}

TEST(OuterLayer, AnInsoleAtTheHeightOfTheCreaseGoes) {
  for (int i = 0; i < 200000; ++i)
    wall.places.push_back({wall.any(0, 600), wall.any(-0.03F, 0.03F), wall.any(0, 60)});
  const std::size_t outside = wall.places.size();
  // It reaches the wall's back without a gap.
  for (int i = 0; i < 80000; ++i)
    wall.places.push_back({wall.any(0, 600), wall.any(-25, -1.0F), 30 + wall.any(-0.1F, 0.1F)});
  keep_outer_layer(wall.places, k_config);
  std::size_t left = 0;
  for (std::size_t i = outside; i < wall.places.size(); ++i) {
    const OutlinePlace& place = wall.places[i];
    left += place.s_mm >= 0 || hollow_s_mm(place) >= 0 ? 1 : 0;
  }
  CHECK_COMPARE(static_cast<double>(left), <,
                k_by_chance_ratio * static_cast<double>(wall.places.size() - outside));
}

TEST(OuterLayer, ABottomThatTheRowsAreTooHighForIsKeptAsOne) {
  // Two points per square millimetre: the envelope's rows are as high as the groove is wide.
  const std::vector<OutlinePlace> all = [] {
    std::vector<OutlinePlace> places;
    for (float s_mm = 0.5F; s_mm < 600; s_mm += 2.5F)
      for (float z_mm = std::fmod(s_mm, 0.2F); z_mm < 60; z_mm += 0.2F)
        places.push_back({s_mm, std::min(0.0F, 1.6F * (std::abs(z_mm - 30.1F) - 1.1F)), z_mm});
    return places;
  }();
  wall.places = all;
  keep_outer_layer(wall.places, k_config);
  std::size_t taken_out = 0;
  std::size_t lost = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (std::abs(all[i].z_mm - 30.1F) > 0.3F || wall.places[i].s_mm >= 0) continue;
    ++taken_out;
    if (hollow_s_mm(wall.places[i]) < 0)
      ++lost;
    else
      DOUBLES_EQUAL(all[i].s_mm, hollow_s_mm(wall.places[i]), 1e-3);
  }
  CHECK_COMPARE(taken_out, >, 100);
  CHECK_COMPARE(lost, <, taken_out / 20);
}

TEST(OuterLayer, AGrooveKeepsItsBottomWhereProfilesLieApart) {
  // Flanks that go in by two for each millimetre up or down, 2 mm deep; profiles 6 mm apart, dense along
  // themselves.
  for (float s = 0.5F; s < 600; s += 6) {
    for (float z = 0; z < 60; z += 0.1F)
      wall.places.push_back({s, -2 * std::max(0.0F, 1 - std::abs(z - 30.3F)), z});
  }
  keep_outer_layer(wall.places, k_config);
  std::size_t lost = 0;
  for (const OutlinePlace& place : wall.places) lost += place.s_mm < 0 ? 1 : 0;
  UNSIGNED_LONGS_EQUAL(0, lost);
}

}  // namespace biteline::bite_line
