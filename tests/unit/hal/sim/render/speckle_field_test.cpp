// SPDX-License-Identifier: MIT
// The rendered grain against the coherent theory (Goodman 2007; Dorsch, Haeusler, Herrmann 1994).
#include "hal/sim/render/speckle_field.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace biteline::sim {
namespace {

using Grain = SpeckleField::Grain;

/// A picture of the whole field from `places` on, averaged: row after row in each column.
std::vector<Grain> picture(const SpeckleField& field, const std::vector<SpeckleField::Place>& places) {
  std::vector<Grain> all, column(SpeckleField::k_rows);
  for (int i = 0; i < SpeckleField::k_columns; ++i) {
    column.assign(column.size(), {});
    for (const auto& place : places) field.add(place, {.column = i, .first_row = 0}, column);
    for (Grain& grain : column) {
      grain.along /= static_cast<float>(places.size());
      grain.across /= static_cast<float>(places.size());
    }
    all.insert(all.end(), column.begin(), column.end());
  }
  return all;
}

std::vector<double> polarised(const std::vector<Grain>& grains, double ratio) {
  std::vector<double> light;
  for (const Grain& grain : grains)
    light.push_back(0.5 * (1 + ratio) * static_cast<double>(grain.along) +
                    0.5 * (1 - ratio) * static_cast<double>(grain.across));
  return light;
}

double mean(const std::vector<double>& light) {
  double sum = 0;
  for (const double value : light) sum += value;
  return sum / static_cast<double>(light.size());
}

double contrast(const std::vector<double>& light) {
  const double middle = mean(light);
  double squares = 0;
  for (const double value : light) squares += std::pow(value - middle, 2);
  return std::sqrt(squares / static_cast<double>(light.size())) / middle;
}

/// Of one polarisation, pixels so many rows apart.
double likeness_of_rows(const std::vector<double>& light, int apart) {
  double sum = 0, own = 0;
  for (int column = 0; column < SpeckleField::k_columns; ++column) {
    for (int row = 0; row < SpeckleField::k_rows; ++row) {
      const auto at = [&](int r) {
        return light[static_cast<std::size_t>(column * SpeckleField::k_rows + r % SpeckleField::k_rows)] - 1;
      };
      sum += at(row) * at(row + apart);
      own += at(row) * at(row);
    }
  }
  return sum / own;
}

}  // namespace

TEST_GROUP(SpeckleField){};

TEST(SpeckleField, ContrastIsThatOfCoherentTheory) {
  for (const double f_number : {2.8, 4.0, 5.6, 8.0, 16.0}) {
    const optics::SpeckleOptics optics{.f_number = f_number};
    const SpeckleField sut(optics);
    const auto grains = picture(sut, {{}});
    for (const double ratio : {0.0, 0.5, 1.0}) {
      const double expected = optics::pixel_contrast(optics) * optics::polarised_contrast(ratio);
      DOUBLES_EQUAL(1, mean(polarised(grains, ratio)), 1e-3);
      DOUBLES_EQUAL(expected, contrast(polarised(grains, ratio)), 0.05 * expected);
    }
  }
}

TEST(SpeckleField, FullyDevelopedIsExponentialWhereTheGrainIsMuchLargerThanThePixel) {
  const optics::SpeckleOptics optics{.f_number = 22, .pixel_um = 1.1};
  const auto light = polarised(picture(SpeckleField(optics), {{}}), 1);
  DOUBLES_EQUAL(1, contrast(light), 0.05);
  std::size_t dark = 0;
  for (const double value : light) dark += value < 0.5 ? 1U : 0U;
  DOUBLES_EQUAL(1 - std::exp(-0.5), static_cast<double>(dark) / static_cast<double>(light.size()), 0.02);
}

TEST(SpeckleField, UnrelatedPatternsAverageByTheRootOfTheirNumber) {
  const optics::SpeckleOptics optics{.f_number = 5.6};
  const SpeckleField sut(optics);
  const double one = contrast(polarised(picture(sut, {{}}), 1));
  for (const int count : {2, 4, 9}) {
    std::vector<SpeckleField::Place> places;
    for (int i = 0; i < count; ++i) places.push_back({.column_half_px = 74 * i, .row_half_px = 46 * i});
    const double expected = one / std::sqrt(count);
    DOUBLES_EQUAL(expected, contrast(polarised(picture(sut, places), 1)), 0.05 * expected);
  }
}

TEST(SpeckleField, GrainIsTheLenss) {
  // Pixels finer than the grain show it: the first place without likeness is 1.22 lambda N (1 + m) away.
  const optics::SpeckleOptics optics{.f_number = 8, .pixel_um = 0.8};
  const auto light = polarised(picture(SpeckleField(optics), {{}}), 1);
  const double zero_px = optics::grain_um(optics) / optics.pixel_um;
  for (const double part : {0.25, 0.5, 0.75, 1.0}) {
    const int apart = static_cast<int>(std::lround(part * zero_px));
    DOUBLES_EQUAL(optics::likeness(optics, apart * optics.pixel_um), likeness_of_rows(light, apart), 0.05);
  }
}

TEST(SpeckleField, MotionAveragesAsTheoryHasIt) {
  const optics::SpeckleOptics optics{.f_number = 5.6};
  const SpeckleField sut(optics);
  for (const int half_px : {2, 4, 8, 16}) {
    std::vector<SpeckleField::Place> places;
    for (int i = 0; i < half_px; ++i) places.push_back({.row_half_px = i});
    const double expected = optics::pixel_contrast(optics, 0.5 * half_px);
    DOUBLES_EQUAL(expected, contrast(polarised(picture(sut, places), 1)), 0.06 * expected);
  }
}

TEST(SpeckleField, HalfPixelsBelongToTheSamePattern) {
  const SpeckleField sut({.f_number = 8});
  const auto at_rest = polarised(picture(sut, {{}}), 1),
             moved = polarised(picture(sut, {{.row_half_px = 1}}), 1),
             elsewhere = polarised(picture(sut, {{.row_half_px = 101}}), 1);
  const auto alike = [&](const std::vector<double>& other) {
    double sum = 0;
    for (std::size_t i = 0; i < other.size(); ++i) sum += (at_rest[i] - 1) * (other[i] - 1);
    return sum / static_cast<double>(other.size()) / std::pow(contrast(at_rest), 2);
  };
  CHECK(alike(moved) > 0.6);
  CHECK(std::fabs(alike(elsewhere)) < 0.05);
}

/// A spot of light with a Gaussian profile, twice as wide as a grain or more, and a detector that counts all
/// of it: its centre of gravity strays by Dorsch's limit over the root of 2.  (The variance of the sum of
/// place times light is the area of likeness, lambda^2 / (pi sin^2 u), times the integral of (x I)^2, over
/// the square of the integral of I: 1 / (8 pi) of that area.)
TEST(SpeckleField, AnIdealDetectorMeetsDorschsLimit) {
  const optics::SpeckleOptics optics{.f_number = 5.6, .pixel_um = 1.5};
  const SpeckleField sut(optics);
  const auto light = polarised(picture(sut, {{}}), 1);
  constexpr int k_reach = 20;
  constexpr double k_sigma_px = 5;
  double squares = 0;
  int count = 0;
  for (int u = k_reach; u + k_reach < SpeckleField::k_columns; u += 8) {
    for (int v = k_reach; v + k_reach < SpeckleField::k_rows; v += 8) {
      double sum = 0, moment = 0;
      for (int x = -k_reach; x <= k_reach; ++x) {
        for (int y = -k_reach; y <= k_reach; ++y) {
          const double seen = std::exp(-0.5 * (x * x + y * y) / (k_sigma_px * k_sigma_px)) *
                              light[static_cast<std::size_t>((u + x) * SpeckleField::k_rows + v + y)];
          sum += seen;
          moment += seen * y;
        }
      }
      squares += std::pow(moment / sum, 2);
      ++count;
    }
  }
  const double object_um = std::sqrt(squares / count) * optics.pixel_um / optics.magnification;
  const double expected_um = optics::dorsch_limit_um(optics, 1) / std::sqrt(2);
  DOUBLES_EQUAL(expected_um, object_um, 0.1 * expected_um);
}

}  // namespace biteline::sim
