// SPDX-License-Identifier: MIT
#include "host/cloud/curvature/scan_surface.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace biteline::curvature {
namespace {

constexpr float k_noise_mm = 0.015F;
constexpr float k_column_mm = 0.07F;

/// One profile of a tube about z, radius R, at an azimuth: the stripe runs along z over a valley of 1.5 mm
/// radius about z = 0 (its rim at z = +-1.3), as a groove round a shoe.
struct Tube {
  float radius_mm{20};
  bool grooved{false};
  std::mt19937 random{7};

  struct Profile {
    std::vector<Eigen::Vector3f> points, normals;
    std::vector<std::uint16_t> columns;
    Eigen::Vector3f eye;
  };
  Profile at(float azimuth_rad) {
    constexpr float k_groove_mm = 1.5F, k_rim_mm = 1.3F;
    std::normal_distribution<float> noise{0, k_noise_mm};
    const Eigen::Vector3f out{std::cos(azimuth_rad), std::sin(azimuth_rad), 0};
    Profile profile{.points = {},
                    .normals = {},
                    .columns = {},
                    .eye = (radius_mm + 200) * out + Eigen::Vector3f{0, 0, 40}};
    for (std::uint16_t column = 0; column < 200; ++column) {
      const float z = k_column_mm * (column - 100);
      float r = radius_mm;
      Eigen::Vector3f normal = out;
      if (grooved && std::abs(z) < k_rim_mm) {
        const auto floor = [&](float at) { return std::sqrt(k_groove_mm * k_groove_mm - at * at); };
        r -= floor(z) - floor(k_rim_mm);
        normal = (floor(z) * out - z * Eigen::Vector3f::UnitZ()).normalized();
      }
      profile.points.emplace_back((r + noise(random)) * out + z * Eigen::Vector3f::UnitZ());
      profile.normals.push_back(normal);
      profile.columns.push_back(static_cast<std::uint16_t>(column + 300));
    }
    return profile;
  }
};

struct Scan {
  ScanSurface surface;
  std::vector<Eigen::Vector3f> points, truth;

  void add(const Tube::Profile& profile) {
    points.insert(points.end(), profile.points.begin(), profile.points.end());
    truth.insert(truth.end(), profile.normals.begin(), profile.normals.end());
    surface.add_profile(profile.points, profile.columns, profile.eye);
  }
  void finish() {
    surface.finish();
    LONGS_EQUAL(points.size(), surface.normals().size());
    LONGS_EQUAL(points.size(), surface.mean_per_mm().size());
  }
  [[nodiscard]] double normal_rms_deg() const {
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      DOUBLES_EQUAL(1.0, surface.normals()[i].norm(), 1e-4);
      sum += std::pow(std::acos(std::min(1.0F, surface.normals()[i].dot(truth[i]))), 2);
    }
    return std::sqrt(sum / static_cast<double>(truth.size())) * 180 / std::numbers::pi;
  }
  /// Median over the points within 0.2 mm of a height, from the third profile to the third last.
  [[nodiscard]] double mean_curvature_at(float z) const {
    std::vector<float> values;
    for (std::size_t i = 400; i + 400 < points.size(); ++i) {
      if (std::abs(points[i].z() - z) < 0.2F) values.push_back(surface.mean_per_mm()[i]);
    }
    std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
    return static_cast<double>(values[values.size() / 2]);
  }
};

Scan scan_of(Tube tube, float step_mm, int profiles) {
  Scan scan;
  for (int i = 0; i < profiles; ++i) scan.add(tube.at(static_cast<float>(i) * step_mm / tube.radius_mm));
  scan.finish();
  return scan;
}

constexpr std::array k_steps_mm{0.1F, 0.5F, 1.1F, 2.2F};

}  // namespace

TEST_GROUP(ScanSurface){};

TEST(ScanSurface, TubeHasItsNormalsAndItsCurvatureAtEachSpacingOfProfiles) {
  for (const float step : k_steps_mm) {
    const Scan sut = scan_of({}, step, 40);
    // At a scan's ends, a neighbourhood of radius r has one side only and leans by r / 2 / 20 mm: 2.1 degrees
    // at r = 1.5 mm. At 0.1 mm that is 30 of 40 profiles, by half of it in the mean; at 2.2 mm (r = 2.9) two
    // of 40.  The noise adds 0.3 degrees.
    CHECK_COMPARE(sut.normal_rms_deg(), <, 1.1);
    DOUBLES_EQUAL(1.0 / 40, sut.mean_curvature_at(0), 0.004);
  }
}

TEST(ScanSurface, GrooveRoundATubeIsConcave) {
  for (const float step : {0.5F, 1.1F}) {
    const Scan sut = scan_of({.grooved = true}, step, 40);
    // Half of the groove's -1/1.5 and the tube's 1/19: the quadric over the whole groove reads its floor to a
    // tenth.
    DOUBLES_EQUAL(0.5 * (-1 / 1.5 + 1 / 19.3), sut.mean_curvature_at(0), 0.035);
    DOUBLES_EQUAL(1.0 / 40, sut.mean_curvature_at(5), 0.006);
  }
}

TEST(ScanSurface, ProfilesAreGivenOutAsTheScanGoesOn) {
  Tube tube;
  ScanSurface sut;
  for (int i = 0; i < 20; ++i) {
    const Tube::Profile p = tube.at(static_cast<float>(i) * 1.1F / tube.radius_mm);
    sut.add_profile(p.points, p.columns, p.eye);
  }
  // Twice the widest neighbourhood of 4 mm is the most that may be outstanding.
  CHECK_COMPARE(sut.normals().size(), >=, 200U * 12);
}

TEST(ScanSurface, ProfileAloneLooksAtTheCameraAndHasNoCurvature) {
  Scan sut = scan_of({}, 1, 1);
  for (std::size_t i = 0; i < sut.points.size(); ++i) {
    CHECK_COMPARE(sut.surface.normals()[i].x(), >, 0.9F);
    CHECK_COMPARE(std::abs(sut.surface.normals()[i].z()), <, 0.3F);
    CHECK(std::isnan(sut.surface.mean_per_mm()[i]));
  }
}

TEST(ScanSurface, GapsAreNotBridged) {
  Tube tube, other{.radius_mm = 60};
  Scan sut;
  for (int i = 0; i < 5; ++i) sut.add(tube.at(static_cast<float>(i) * 0.055F));
  for (int i = 0; i < 5; ++i) sut.add(other.at(2 + static_cast<float>(i) * 0.018F));
  sut.finish();
  CHECK_COMPARE(sut.normal_rms_deg(), <, 1.2);
}

TEST(ScanSurface, HeadThatStandsStillKeepsMemoryBoundedAndAllPoints) {
  Tube tube;
  Scan sut;
  for (int i = 0; i < 700; ++i) sut.add(tube.at(0));
  for (int i = 1; i < 6; ++i) sut.add(tube.at(static_cast<float>(i) * 0.055F));
  sut.finish();
  for (std::size_t i = 0; i < sut.points.size(); ++i) CHECK(sut.surface.normals()[i].allFinite());
}

TEST(ScanSurface, PointsAtInfinityEndAsPointsToo) {
  // Their difference to themselves is no number: a loop that waits for it to be small would never end.
  Tube tube;
  Scan sut;
  for (int i = 0; i < 5; ++i) {
    Tube::Profile profile = tube.at(static_cast<float>(i) * 0.055F);
    profile.points[50].x() = std::numeric_limits<float>::infinity();
    profile.points[120] = Eigen::Vector3f::Constant(3e38F);
    sut.add(profile);
  }
  sut.finish();
  LONGS_EQUAL(sut.points.size(), sut.surface.normals().size());
  std::feclearexcept(FE_ALL_EXCEPT);  // raised on purpose
}

TEST(ScanSurface, EmptyProfileHarmsNoOther) {
  Tube tube;
  Scan sut;
  for (int i = 0; i < 10; ++i) {
    Tube::Profile profile = tube.at(static_cast<float>(i) * 0.055F);
    if (i == 4) profile = {.points = {}, .normals = {}, .columns = {}, .eye = profile.eye};
    sut.add(profile);
  }
  sut.finish();
  CHECK_COMPARE(sut.normal_rms_deg(), <, 2.2);  // all ends: 2.1 degrees
}

}  // namespace biteline::curvature
