// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/true_line.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::sim {

namespace {

/// The definition, spelled out by sums and differences, without any of the module's own steps.
double brute_force_height_mm(const Section& section) {
  constexpr double k_sigma_mm = 0.4, k_sum_step_mm = 0.01, k_difference_mm = 0.02;
  const auto smoothed = [&](double z_mm) {
    double sum = 0, weights = 0;
    for (double d = -2; d <= 2.0001; d += k_sum_step_mm) {
      const double weight = std::exp(-d * d / (2 * k_sigma_mm * k_sigma_mm));
      sum += weight * section.offset_mm(z_mm + d);
      weights += weight;
    }
    return sum / weights;
  };
  double best_k = -1e9, best_z_mm = 0;
  for (double z_mm = section.line_height_mm() - 2.5; z_mm <= section.line_height_mm() + 2.5; z_mm += 0.02) {
    const double below = smoothed(z_mm - k_difference_mm), here = smoothed(z_mm),
                 above = smoothed(z_mm + k_difference_mm);
    const double slope = (above - below) / (2 * k_difference_mm);
    const double k =
        (above - 2 * here + below) / (k_difference_mm * k_difference_mm) / std::pow(1 + slope * slope, 1.5);
    if (k > best_k) {
      best_k = k;
      best_z_mm = z_mm;
    }
  }
  return best_z_mm;
}

PlaceDefinition without_running_mean() {
  return {.running_mean_mm = 1e-6};
}

}  // namespace

TEST_GROUP(TrueLine){};

TEST(TrueLine, HeightIsThatOfTheDefinitionByBruteForce) {
  for (const ShoeClass shoe_class :
       {ShoeClass::Deep, ShoeClass::Shallow, ShoeClass::Step, ShoeClass::Stitched}) {
    const MadeShoe shoe(draw_shoe(shoe_class, 5));
    const auto sut = true_line(shoe, 60, without_running_mean());
    for (const auto& place : sut) {
      // Two grids of 0.02 mm, one refined.
      DOUBLES_EQUAL(brute_force_height_mm(shoe.section(place.s_mm)), place.point_shoe.z(), 0.02);
    }
  }
}

TEST(TrueLine, LiesOnTheUnsmoothedSurfaceAnticlockwiseAndEvenlySpaced) {
  const MadeShoe shoe(draw_shoe(ShoeClass::Deep, 9));
  const auto sut = true_line(shoe, 1.0);
  double area_mm2 = 0;
  for (std::size_t i = 0; i < sut.size(); ++i) {
    const auto& here = sut[i];
    const auto& next = sut[(i + 1) % sut.size()];
    DOUBLES_EQUAL(0, (shoe.section(here.s_mm).point(here.point_shoe.z()) - here.point_shoe).norm(), 1e-9);
    area_mm2 += 0.5 * (here.point_shoe.x() * next.point_shoe.y() - here.point_shoe.y() * next.point_shoe.x());
    const double gap_mm = (next.point_shoe - here.point_shoe).norm();
    CHECK(gap_mm > 0.6 && gap_mm < 1.3);
  }
  CHECK(area_mm2 > 5000);
}

TEST(TrueLine, RunningMeanOfAStraightRampIsTheRamp) {
  std::vector<SmoothedSection> sections;
  constexpr int k_count = 100;
  for (int i = 0; i < k_count; ++i) {
    SmoothedSection section{
        .first_z_mm = 0.1 * std::sin(2 * M_PI * i / k_count), .step_mm = 0.5, .curvature_per_mm = {0, 1, 0}};
    sections.push_back(section);
  }
  const auto heights = line_heights(sections, 1.0, {.running_mean_mm = 8});
  for (int i = 0; i < k_count; ++i) {
    // A sine keeps its phase and loses 1 - (pi w / n)^2 / 6 of its height in a window w.
    DOUBLES_EQUAL(0.5 + 0.1 * std::sin(2 * M_PI * i / k_count), heights.z_mm[static_cast<std::size_t>(i)],
                  0.1 * 0.012);
  }
}

TEST(TrueLine, NormalsPointOutwardsFromTheUpper) {
  const MadeShoe shoe(draw_shoe(ShoeClass::Deep, 9));
  for (const auto& place : true_line(shoe, 10)) {
    DOUBLES_EQUAL(1, place.normal_shoe.norm(), 1e-9);
    const Vec2 outward = shoe.section(place.s_mm).place().normal;
    CHECK(place.normal_shoe.head<2>().dot(outward) > 0.85);
  }
}

TEST(TrueLine, CreaseTellsAFilledStretchFromAnOpenOne) {
  ShoeParameters parameters = draw_shoe(ShoeClass::Deep, 4);
  parameters.filled = {{.s_mm = 100, .half_length_mm = 15, .soft_mm = 3}};
  const auto line = true_line(MadeShoe(parameters), 2);
  double open_per_mm = 1e9, filled_per_mm = 0;
  for (const auto& place : line) {
    const double way_mm = std::abs(place.s_mm - 100);
    if (way_mm < 10) filled_per_mm = std::max(filled_per_mm, place.crease_per_mm);
    if (way_mm > 25) open_per_mm = std::min(open_per_mm, place.crease_per_mm);
  }
  CHECK(filled_per_mm < 0.5 * open_per_mm);
}

TEST(TrueLine, ABareUpperHasNoneAndTakesItsSamplesAtEqualHeight) {
  const ShoeParameters sample = draw_shoe(ShoeClass::Deep, 11);
  const auto line = true_line(MadeShoe(sample), 5);
  const MadeShoe bare(bare_upper_of(sample, 0.15, 4));
  LONGS_EQUAL(0, true_line(bare, 5).size());
  const auto carried = carried_line(line, bare);
  LONGS_EQUAL(line.size(), carried.size());
  for (std::size_t i = 0; i < line.size(); ++i) {
    DOUBLES_EQUAL(line[i].point_shoe.z(), carried[i].point_shoe.z(), 1e-12);
    DOUBLES_EQUAL(
        0, (bare.section(carried[i].s_mm).point(carried[i].point_shoe.z()) - carried[i].point_shoe).norm(),
        1e-9);
  }
}

}  // namespace biteline::sim
