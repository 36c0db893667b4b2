// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "host/bite_line/curve/curve_costs.hpp"
#include "host/bite_line/curve/curve_on_side.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "tests/unit/host/bite_line/curve/blank_side.hpp"
#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line::test {

namespace {

Raster raster_of(const Side& side) {
  const SideGrid& grid = side.field.grid;
  return Raster::of({side.field.places.data(), side.field.places.size()}, side.outline.length_mm(),
                    grid.z_low_mm, grid.rows * grid.row_mm, side.field.points_per_mm2);
}

/// Sole below `z_mm`, upper above it: the sole stands out by a millimetre.
double stepped_mm(double z, double at_mm) {
  constexpr double k_step_mm = 1.0, k_lean = 0.1;
  return z < at_mm ? 0.0 : -k_step_mm - k_lean * (z - at_mm);
}

/// A sole that is nearly flush: it ends at `at_mm`, and the upper leans outwards for 12 mm.
double faint_mm(double z, double at_mm) {
  constexpr double k_step_mm = 0.35, k_lean = 0.2, k_up_mm = 12;
  const double up_mm = z - at_mm;
  return up_mm < 0 ? 0.0
                   : -k_step_mm + k_lean * std::min(up_mm, k_up_mm) - k_lean * std::max(0.0, up_mm - k_up_mm);
}

bool everywhere(double) {
  return true;
}

/// The share of a drum's best curve that lies within 1.5 mm of a height, where `at` holds.
double share_at(const std::function<double(double s, double z)>& surface, double z_mm,
                const std::function<bool(double s)>& at) {
  const Side side = drum_side(surface);
  CurveGround ground = curve_ground(side);
  const auto found = best_curve(ground, {}, [](auto, auto) { return 0.0; });
  CHECK(found.has_value());
  double near = 0, all = 0;
  for (const CurveState& state : found->curve.states) {
    const Vec2 place = ground.raster.place(state.row, ground.raster.round_col(state.col));
    if (!at(place.x())) continue;
    all += 1;
    near += std::abs(place.y() - z_mm) < 1.5 ? 1 : 0;
  }
  return near / all;
}

struct ForgivesUnderflow : Utest {
  void teardown() override { forgive_underflow(); }
};

}  // namespace

TEST_GROUP_BASE(CurveCosts, ForgivesUnderflow){};

TEST(CurveCosts, AStepAllRoundIsCheapInItsDirectionAlone) {
  const Side side = drum_side([](double, double z) { return stepped_mm(z, 25); });
  const Raster raster = raster_of(side);
  CreaseLooks looks{raster};
  const CurveCosts costs = curve_costs(raster, looks, fitted_weights());
  const int row = static_cast<int>(std::lround(raster.row_of(25)));
  const auto least = [&](std::size_t direction, int at) {
    float cost = k_most_cost_per_mm;
    for (int r = at - 1; r <= at + 1; ++r) cost = std::min(cost, costs.of(costs.at(r, 100), direction));
    return cost;
  };
  CHECK(least(k_level_direction, row) < 0.5F);
  CHECK(least(k_level_direction + 4, row) > 1.0F);
  CHECK(least(k_level_direction, row + 15) > 1.0F);
}

TEST(CurveCosts, ACurveFollowsAStepThatRisesUprightRoundTheToe) {
  const auto height_mm = [](double s) { return s > 300 && s < 340 ? 40.0 : 25.0; };
  const Side side = drum_side([&](double s, double z) { return stepped_mm(z, height_mm(s)); });
  const Raster raster = raster_of(side);
  CreaseLooks looks{raster};
  const CurveCosts costs = curve_costs(raster, looks, fitted_weights());
  const std::optional<ClosedCurve> curve = CurveSearch{costs, {}}.best();
  CHECK(curve.has_value());
  for (const CurveState& at : curve->states) {
    const Vec2 place = raster.place(at.row, raster.round_col(at.col));
    const bool beside_flank = std::abs(place.x() - 300) < 3 || std::abs(place.x() - 340) < 3;
    if (!beside_flank) DOUBLES_EQUAL(height_mm(place.x()), place.y(), 1.2);
  }
}

TEST_GROUP(BestCurve){};

TEST(BestCurve, AFaintStepAllRoundIsTheLineAndAPlainLedgeBelowItIsNot) {
  const auto surface = [](double, double z) { return (z < 25 ? 1.5 : 0.0) + faint_mm(z, 33); };
  CHECK_COMPARE(share_at(surface, 33, everywhere), >, 0.98);
}

TEST(BestCurve, AGrooveAllRoundAboveTheStepIsASeam) {
  const auto surface = [](double, double z) {
    return stepped_mm(z, 25) - 0.25 * std::max(0.0, 1 - std::abs(z - 35) / 0.8);
  };
  CHECK_COMPARE(share_at(surface, 25, everywhere), >, 0.98);
}

TEST(BestCurve, APlainEdgeBelowAFaintLineIsNotTakenOverAPart) {
  const auto by_bumper = [](double s) { return s > 290 && s < 370; };
  const auto surface = [&](double s, double z) {
    return (by_bumper(s) && z > 12 && z < 27 ? 1.2 : 0.0) + faint_mm(z, 33);
  };
  CHECK_COMPARE(share_at(surface, 33, by_bumper), >, 0.9);
}

TEST_GROUP_BASE(FindByCurve, ForgivesUnderflow){};

TEST(FindByCurve, AnotherWayOfAStretchIsACandidate) {
  // A faint step; over 60 mm it is two, 4 mm above and below, of which the lower one takes six tenths.
  constexpr double k_from_mm = 290, k_to_mm = 350, k_half_mm = 4, k_step_mm = 0.35, k_lower_share = 0.6;
  cloud::PointCloud cloud;
  cloud.points = drum_points(egg_outline(), [](double s, double z) {
    const double beyond_mm = std::max({0.0, k_from_mm - s, s - k_to_mm});
    const double by_mm = std::max(0.0, k_half_mm - beyond_mm);
    return -0.1 * std::max(0.0, z - 25) - (z > 25 - by_mm ? k_lower_share * k_step_mm : 0) -
           (z > 25 + by_mm ? (1 - k_lower_share) * k_step_mm : 0);
  });
  const Extraction found = find_bite_line(cloud, {});
  CHECK(found.candidates.size() > 1);
  const std::vector<Vec3>&one = found.candidates[0].points, &other = found.candidates[1].points;
  LONGS_EQUAL(one.size(), other.size());
  double most_mm = 0;
  for (std::size_t i = 0; i < one.size(); ++i)
    most_mm = std::max(most_mm, std::abs(one[i].z() - other[i].z()));
  DOUBLES_EQUAL(2 * k_half_mm, most_mm, 1.0);
}

TEST_GROUP(CurveRaster){};

TEST(CurveRaster, APlaneIsReadAsItself) {
  std::vector<OutlinePlace> places;
  constexpr double k_along = 0.2, k_up = -0.5;
  for (double s = 0.1; s < k_turn_mm; s += 0.4)
    for (double z = 10.1; z < 40; z += 0.4)
      places.push_back(
          {static_cast<float>(s), static_cast<float>(k_along * s + k_up * z), static_cast<float>(z)});
  const Raster raster = Raster::of(places, k_turn_mm, 10, 30, 6);
  const int row = raster.rows / 2, col = raster.cols / 2;
  const std::size_t cell = raster.at(row, col);
  const Vec2 place = raster.place(row, col);
  CHECK(raster.seen[cell] != 0);
  DOUBLES_EQUAL(k_along * place.x() + k_up * place.y(), static_cast<double>(raster.o_mm[cell]), 0.02);
  DOUBLES_EQUAL(k_up, static_cast<double>(raster.up_ratio[cell]), 0.06);
  DOUBLES_EQUAL(k_along, static_cast<double>(raster.along_ratio[cell]), 0.04);
}

TEST(CurveRaster, BetweenProfilesTwoMillimetresApartTheSurfaceIsSeen) {
  std::vector<OutlinePlace> places;
  for (double s = 0.3; s < k_turn_mm; s += 2)
    for (double z = 10.1; z < 40; z += 0.15)
      places.push_back({static_cast<float>(s), 0, static_cast<float>(z)});
  const Raster raster = Raster::of(places, k_turn_mm, 10, 30, 3.3);
  LONGS_EQUAL(raster.size(), std::ranges::count(raster.seen, 1));
}

}  // namespace biteline::bite_line::test
