// SPDX-License-Identifier: MIT
#include "host/intake/cloud_builder.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "host/intake/account.hpp"
#include "tests/support/made_profile.hpp"

namespace biteline::intake {

TEST_GROUP(CloudBuilder) {
  geometry::SensorModel sensor;
  profile::Profile profile = test::made_profile(0, 5);

  void setup() override {
    sensor.T_flange_cam = geometry::make_se3(
        Eigen::Quaterniond{Eigen::AngleAxisd{0.7, Vec3{3, -1, 2}.normalized()}}, {9, 150, 250});
    profile.header.flags = 0;
    for (profile::ProfilePoint& point : profile.points) point.flags = 0;
  }
};

TEST(CloudBuilder, PointsGoFromCameraOverFlangeToBase) {
  CloudBuilder sut{sensor};
  sut.add(profile);
  LONGS_EQUAL(5, sut.cloud().size());
  for (std::size_t i = 0; i < 5; ++i) {
    const Vec3 expected =
        profile.header.T_base_flange * (sensor.T_flange_cam * profile.points[i].point_cam.cast<double>());
    // Single precision at 1 m: 0.00006 mm per step.
    constexpr double k_tolerance_mm = 2e-4;
    CHECK((expected - sut.cloud().points[i].cast<double>()).norm() < k_tolerance_mm);
    LONGS_EQUAL(profile.points[i].column, sut.cloud().column[i]);
    LONGS_EQUAL(0, sut.cloud().profile[i]);
    DOUBLES_EQUAL(profile.points[i].sigma_mm, sut.cloud().sigma_mm[i], 0);
  }
  CHECK(sut.cloud().organised());
}

TEST(CloudBuilder, TheStripeOfThePointsThatStayComesAlong) {
  CloudBuilder sut{sensor};
  const auto number = [](std::size_t i) { return static_cast<float>(i); };
  for (std::size_t i = 0; i < 5; ++i) {
    profile.points[i].amplitude = 100 + number(i);
    profile.points[i].width_px = 4 + number(i);
  }
  profile.points[1].flags = profile::k_point_reflection;
  profile.points[2].amplitude = -3;
  profile.points[3].amplitude = std::numeric_limits<float>::quiet_NaN();
  CHECK(sut.stripe_of_last().amplitude.empty());
  sut.add(profile);
  profile.header.sequence = 1;
  profile.points.resize(1);
  sut.add(profile);
  CHECK((sut.cloud().amplitude == std::vector<float>{100, 0, 0, 104, 100}));
  CHECK((sut.cloud().width_px == std::vector<float>{4, 6, 7, 8, 4}));
  LONGS_EQUAL(1, sut.stripe_of_last().amplitude.size());
  DOUBLES_EQUAL(100, sut.stripe_of_last().amplitude[0], 0);
  LONGS_EQUAL(1, sut.stripe_of_last().flags.size());
  const cloud::PointCloud taken = sut.take();
  LONGS_EQUAL(taken.size(), taken.amplitude.size());
}

TEST(CloudBuilder, PlacesBeyondAllArmsStayOut) {
  CloudBuilder sut{sensor};
  profile.points[1].point_cam.z() = 3e8F;
  profile.points[3].point_cam.x() = -2e5F;
  sut.add(profile);
  LONGS_EQUAL(3, sut.cloud().size());
  LONGS_EQUAL(3, sut.counts().points_used);
  LONGS_EQUAL(2, sut.counts().points_not_surface);
}

TEST(CloudBuilder, ScanLastsFromTheFirstExposureToTheLastWhateverTheStampsAre) {
  CloudBuilder sut{sensor};
  profile.header.exposure_mid = SensorClock::time_point{Nanoseconds{7'000'000'000}};
  sut.add(profile);
  DOUBLES_EQUAL(0, sut.counts().duration_s, 0);
  profile.header.sequence = 1;
  profile.header.exposure_mid += Nanoseconds{6'250'000'000};
  sut.add(profile);
  DOUBLES_EQUAL(6.25, sut.counts().duration_s, 1e-9);
  profile.header.sequence = 2;
  profile.header.exposure_mid = SensorClock::time_point::min();
  sut.add(profile);
  CHECK(std::isfinite(sut.counts().duration_s));
}

TEST(CloudBuilder, EachUnusableProfileStaysOutAndIsCountedUnderItsReason) {
  for (const std::uint32_t flag :
       {profile::k_profile_pose_missing, profile::k_profile_pose_stale, profile::k_profile_trigger_mismatch,
        profile::k_profile_clock_unsure, profile::k_profile_frame_damaged}) {
    CloudBuilder sut{sensor};
    profile.header.flags = flag;
    sut.add(profile);
    LONGS_EQUAL(0, sut.cloud().size());
    LONGS_EQUAL(0, sut.counts().profiles_used);
    LONGS_EQUAL(5, sut.counts().points_of_unusable_profiles);
    LONGS_EQUAL(1, profile_flag_counts(sut.counts()).size());
    LONGS_EQUAL(1, profile_flag_counts(sut.counts())[0].second);
    CHECK(profile_flag_counts(sut.counts())[0].first.substr(0, 3) != "bit");
  }
}

TEST(CloudBuilder, FlagsThatOnlyWarnKeepTheProfile) {
  CloudBuilder sut{sensor};
  profile.header.flags =
      profile::k_profile_overrun | profile::k_profile_frame_gap | profile::k_profile_pose_extrapolated;
  sut.add(profile);
  LONGS_EQUAL(1, sut.counts().profiles_used);
  LONGS_EQUAL(3, profile_flag_counts(sut.counts()).size());
}

TEST(CloudBuilder, EvidenceIsNotSurface) {
  CloudBuilder sut{sensor};
  profile.points[1].flags = profile::k_point_reflection | profile::k_point_saturated;
  profile.points[3].flags = profile::k_point_clipped;
  profile.points[4].flags = profile::k_point_saturated;
  sut.add(profile);
  LONGS_EQUAL(3, sut.cloud().size());
  LONGS_EQUAL(2, sut.counts().points_not_surface);
  std::map<std::string, std::uint64_t> counts;
  for (const auto& [name, count] : point_flag_counts(sut.counts())) counts[name] = count;
  LONGS_EQUAL(2, counts["saturated"]);
  LONGS_EQUAL(1, counts["reflection"]);
}

TEST(CloudBuilder, EveryPointIsAccountedFor) {
  CloudBuilder sut{sensor};
  for (std::uint64_t i = 0; i < 20; ++i) sut.add(test::made_profile(i, 50));  // random flags
  const IngestCounts& counts = sut.counts();
  LONGS_EQUAL(1000, counts.points);
  LONGS_EQUAL(counts.points,
              counts.points_used + counts.points_not_surface + counts.points_of_unusable_profiles);
  LONGS_EQUAL(counts.points_used, sut.cloud().size());
}

TEST(CloudBuilder, FinishedCloudHasANormalTowardsTheCameraForEachPoint) {
  // A stripe across a plane of the camera's, seen from 10 mm further at each profile.
  CloudBuilder sut{sensor};
  const Vec3 normal_cam = Vec3{0.2, -0.1, -1}.normalized();
  profile::Profile plane = test::made_profile(0, 200);
  for (std::uint64_t k = 0; k < 6; ++k) {
    plane.header.sequence = k;
    plane.header.flags = 0;
    plane.header.T_base_flange = SE3::Identity();
    plane.header.T_base_flange.translation().y() = 0.5 * static_cast<double>(k);
    for (std::size_t i = 0; i < plane.points.size(); ++i) {
      const double x = 0.1 * static_cast<double>(i);
      const double z = 250 - (normal_cam.x() * x) / normal_cam.z();
      plane.points[i].point_cam = Vec3{x, 0, z}.cast<float>();
      plane.points[i].flags = 0;
    }
    sut.add(plane);
  }
  const cloud::PointCloud cloud = sut.take();
  LONGS_EQUAL(6 * 200, cloud.normals.size());
  LONGS_EQUAL(6 * 200, cloud.mean_per_mm.size());
  // What the plane is: the stripe's direction and the flange's way span it.
  const Vec3 along = sensor.T_flange_cam.linear() * Vec3{-normal_cam.z(), 0, normal_cam.x()}.normalized();
  const Vec3 truth = along.cross(Vec3::UnitY()).normalized();
  for (const Eigen::Vector3f& normal : cloud.normals) {
    // Coordinates of some 300 mm in single precision are 0.00003 mm apart, over a millimetre.
    DOUBLES_EQUAL(1.0, std::abs(normal.cast<double>().dot(truth)), 1e-5);
    CHECK_COMPARE(normal.cast<double>().dot(sensor.T_flange_cam.linear() * Vec3{0, 0, -1}), >, 0.0);
  }
}

TEST(CloudBuilder, MissingProfilesAreCounted) {
  CloudBuilder sut{sensor};
  for (const std::uint64_t sequence : {2, 3, 6}) {
    profile.header.sequence = sequence;
    sut.add(profile);
  }
  LONGS_EQUAL(2 + 2, sut.counts().profiles_lost);
}

TEST(CloudBuilder, SpecklesContrastIsThatOfTheProfilesThatWereUsed) {
  CloudBuilder sut{sensor};
  CHECK_FALSE(account_of(sut.counts(), {}, {}).contains("speckle_contrast"));
  for (std::uint64_t i = 0; i < 101; ++i) {
    profile.header.sequence = i;
    profile.header.speckle_contrast = 0.2F + 0.001F * static_cast<float>((37 * i) % 101);
    sut.add(profile);
  }
  profile.header.speckle_contrast.reset();
  sut.add(profile);
  profile.header.speckle_contrast = 9.0F;
  profile.header.flags = profile::k_profile_pose_missing;
  sut.add(profile);
  const auto contrast = account_of(sut.counts(), {}, {})["speckle_contrast"];
  DOUBLES_EQUAL(0.250, contrast["median"].get<double>(), 1e-6);
  DOUBLES_EQUAL(0.295, contrast["p95"].get<double>(), 1e-6);
}

}  // namespace biteline::intake
