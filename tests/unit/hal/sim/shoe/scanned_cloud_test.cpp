// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/scanned_cloud.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::sim {

TEST_GROUP(ScannedCloud){};

TEST(ScannedCloud, PointsLieOnTheSurfaceUpToTheNoise) {
  const MadeShoe shoe(draw_shoe(ShoeClass::Deep, 3));
  const ScanSettings settings{.profile_step_mm = 40, .noise_mm = 0.02};
  const SE3 T_base_shoe =
      geometry::make_se3(Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vec3::UnitZ())), {300, -50, 60});
  const ScannedCloud sut = scan_quickly(shoe, settings, T_base_shoe);

  const double profiles = std::round(shoe.perimeter_mm() / settings.profile_step_mm);
  double square_sum = 0;
  for (std::size_t i = 0; i < sut.points.size(); ++i) {
    const Vec3 point = T_base_shoe.inverse() * sut.points[i].cast<double>();
    const double s_mm = shoe.perimeter_mm() * sut.profile[i] / profiles;
    const Section section = shoe.section(s_mm);
    const double offset_mm = (point.head<2>() - section.place().point).dot(section.place().normal);
    const double deviation_mm =
        (offset_mm - section.offset_mm(point.z())) * shoe.normal(s_mm, point.z()).head<2>().norm();
    square_sum += deviation_mm * deviation_mm;
  }
  const double rms_mm = std::sqrt(square_sum / static_cast<double>(sut.points.size()));
  // Along the ray, seen at a slant: the share normal to the surface is a little less than the noise.
  CHECK(rms_mm < settings.noise_mm && rms_mm > 0.7 * settings.noise_mm);
}

TEST(ScannedCloud, ComesInScanOrder) {
  const ScannedCloud sut =
      scan_quickly(MadeShoe(draw_shoe(ShoeClass::Glossy, 3)), {.profile_step_mm = 5}, SE3::Identity());
  for (std::size_t i = 1; i < sut.points.size(); ++i) {
    const bool same = sut.profile[i] == sut.profile[i - 1];
    CHECK(same ? sut.column[i] > sut.column[i - 1] : sut.profile[i] > sut.profile[i - 1]);
  }
}

TEST(ScannedCloud, TheStripeShowsTheMaterialAndChangesNoPoint) {
  ShoeParameters parameters = draw_shoe(ShoeClass::Step, 5);
  parameters.reflectance.upper = {.diffuse_ratio = 0.3, .grain_ratio = 0, .scattering_mm = 0};
  parameters.reflectance.sole = {.diffuse_ratio = 0.6, .grain_ratio = 0, .scattering_mm = 0.2};
  const MadeShoe shoe(parameters);
  const ScanSettings settings{.profile_step_mm = 20, .stripe = true};
  const ScannedCloud sut = scan_quickly(shoe, settings, SE3::Identity());
  const ScannedCloud without = scan_quickly(shoe, {.profile_step_mm = 20}, SE3::Identity());
  CHECK(without.points == sut.points);
  CHECK(without.amplitude.empty());
  LONGS_EQUAL(sut.points.size(), sut.amplitude.size());
  const double profiles = std::round(shoe.perimeter_mm() / settings.profile_step_mm);
  struct Mean {
    double grey{0}, width_px{0}, count{0};
  } above, below;
  for (std::size_t i = 0; i < sut.points.size(); ++i) {
    const double line_z_mm = shoe.section(shoe.perimeter_mm() * sut.profile[i] / profiles).line_height_mm();
    const double above_mm = static_cast<double>(sut.points[i].z()) - line_z_mm;
    if (std::abs(above_mm) < 3 || std::abs(above_mm) > 6) continue;
    Mean& mean = above_mm > 0 ? above : below;
    mean.grey += static_cast<double>(sut.amplitude[i]);
    mean.width_px += static_cast<double>(sut.width_px[i]);
    mean.count += 1;
  }
  // The wider stripe is the lower one, so half the light of the sole goes into its width.
  CHECK_COMPARE(above.grey / above.count, <, 0.8 * below.grey / below.count);
  CHECK_COMPARE(above.width_px / above.count, <, 0.85 * below.width_px / below.count);
}

TEST(ScannedCloud, TheStripesHeightHasTheSpeckleOfTheHeadsLight) {
  ShoeParameters parameters = draw_shoe(ShoeClass::Bare, 5);
  parameters.reflectance.upper = {.diffuse_ratio = 0.3, .grain_ratio = 0, .scattering_mm = 0};
  const ScannedCloud sut =
      scan_quickly(MadeShoe(parameters), {.profile_step_mm = 20, .stripe = true}, SE3::Identity());
  // A point less the mean of its neighbours: variance 1.5 of one's.  Facing and distance change slowly.
  double squares = 0, count = 0;
  for (std::size_t i = 1; i + 1 < sut.points.size(); ++i) {
    if (sut.profile[i - 1] != sut.profile[i + 1] || sut.column[i + 1] - sut.column[i - 1] != 2) continue;
    const double before = static_cast<double>(sut.amplitude[i - 1]),
                 at = static_cast<double>(sut.amplitude[i]),
                 behind = static_cast<double>(sut.amplitude[i + 1]), mean = (before + at + behind) / 3;
    squares += std::pow((at - 0.5 * (before + behind)) / mean, 2) / 1.5;
    count += 1;
  }
  // The simulated head's at f/5.6: contrast 0.471, 1.44 rows a grain, a stripe of 2.2 px.  A mean of three in
  // the denominator adds a few hundredths of it, and some points are hidden or at full scale.
  CHECK_COMPARE(count, >, 5000);
  DOUBLES_EQUAL(0.471 * std::sqrt(1.44 / (std::sqrt(2 * M_PI) * 2.195)), std::sqrt(squares / count), 0.02);
}

TEST(ScannedCloud, HidesWhatTheLipHides) {
  // A lip standing 12 mm out hides the wall right above it from a head standing low.
  ShoeParameters parameters = draw_shoe(ShoeClass::Step, 3);
  parameters.groove.step_mm = 12;
  const MadeShoe shoe(parameters);
  const ScanSettings low{.profile_step_mm = 50,
                         .noise_mm = 0,
                         .camera_distance_mm = 60,
                         .camera_z_mm = 3,
                         .laser_distance_mm = 60,
                         .laser_z_mm = 3};
  const ScannedCloud sut = scan_quickly(shoe, low, SE3::Identity());
  const double profiles = std::round(shoe.perimeter_mm() / low.profile_step_mm);
  for (std::size_t i = 0; i < sut.points.size(); ++i) {
    const double line_z_mm = shoe.section(shoe.perimeter_mm() * sut.profile[i] / profiles).line_height_mm();
    CHECK(sut.points[i].z() < line_z_mm - 0.5 || sut.points[i].z() > line_z_mm + 1);
  }
}

TEST(ScannedCloud, GlossPatchesAreHoles) {
  ShoeParameters parameters = draw_shoe(ShoeClass::Deep, 6);
  const ScannedCloud full = scan_quickly(MadeShoe(parameters), {.profile_step_mm = 3}, SE3::Identity());
  parameters.gloss = {{.s_mm = 80, .u_mm = 0, .half_length_mm = 12, .half_height_mm = 6}};
  const ScannedCloud sut =
      scan_quickly(MadeShoe(parameters), {.profile_step_mm = 3, .gloss_loss_ratio = 1}, SE3::Identity());
  const double missing_mm2 = static_cast<double>(full.points.size() - sut.points.size()) * 3 * 0.073;
  const double patch_mm2 = M_PI * 12 * 6;
  DOUBLES_EQUAL(patch_mm2, missing_mm2, 0.15 * patch_mm2);
}

}  // namespace biteline::sim
