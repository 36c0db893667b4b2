// SPDX-License-Identifier: MIT
// Clock offset and refinement from a made scan: two passes over a wavy surface, to and fro.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/calibration/clock/clock_offset.hpp"
#include "host/calibration/refine/scan_refinement.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::calibration {

TEST_GROUP(ScanSelfConsistency) {
  std::mt19937_64 random{41};
  std::normal_distribution<double> normal{0, 1};
  ScanModel truth;

  void setup() override {
    truth.camera = {.fu_px = 1400,
                    .fv_px = 1390,
                    .cu_px = 405,
                    .cv_px = 292,
                    .k1 = -0.11,
                    .k2 = 0.14,
                    .p1 = 3e-4,
                    .p2 = -2e-4};
    truth.plane = {.normal_cam = Vec3(0.01, 0.704, -0.71).normalized(), .distance_mm = -150};
    truth.T_flange_cam.linear() = Eigen::AngleAxisd(0.2, Vec3(0.3, 1, 0.1).normalized()).toRotationMatrix();
    truth.T_flange_cam.translation() = Vec3(10, -60, 80);
  }

  static double height_mm(double x_mm, double y_mm) {
    return 6 * std::sin(x_mm / 15) + 3 * std::cos(y_mm / 9) + 0.05 * x_mm;
  }

  /// Looking down from some 220 mm, moving to and fro along y with a sway about two axes.
  static SE3 T_base_flange_at(double t_s, const ScanModel& model) {
    const double y_mm = 50 * std::sin(2 * std::numbers::pi * t_s / 1.6);
    SE3 T_base_cam = SE3::Identity();
    T_base_cam.linear() = (Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()) *
                           Eigen::AngleAxisd(0.25 * std::sin(5 * t_s), Vec3::UnitY()) *
                           Eigen::AngleAxisd(0.2 * std::sin(3 * t_s + 1), Vec3::UnitZ()))
                              .toRotationMatrix();
    T_base_cam.translation() = Vec3(8 * std::sin(2 * t_s), y_mm, 215 + 12 * std::sin(7 * t_s));
    return T_base_cam * model.T_flange_cam.inverse();
  }

  /// Pixels where the laser plane meets the surface, column by column.
  Scan scan_of(double offset_s) {
    Scan scan;
    for (int f = 0; f < 160; ++f) {
      const double t_s = 0.1 + 0.01 * f;
      ScanFrame frame{.exposure_mid = SensorClock::time_point{Nanoseconds{std::llround(t_s * 1e9)}},
                      .stripe_px = {}};
      const SE3 T_base_cam = T_base_flange_at(t_s, truth) * truth.T_flange_cam;
      for (int u = 100; u < 720; u += 6) {
        // Along the column the point of the laser plane runs away from the camera; find where it dives below
        // the surface.
        double low = 80, high = 560;
        const auto above = [&](double v) {
          const Vec3 p = T_base_cam * geometry::triangulate(truth.camera, truth.plane, Vec2(u, v));
          return p.z() - height_mm(p.x(), p.y());
        };
        if (above(low) * above(high) > 0) continue;
        const bool rising = above(high) > 0;
        for (int i = 0; i < 40; ++i) {
          const double middle = (low + high) / 2;
          ((above(middle) > 0) == rising ? high : low) = middle;
        }
        frame.stripe_px.emplace_back(u, low + 0.05 * normal(random));
      }
      scan.frames.push_back(std::move(frame));
    }
    for (int k = 0; k < 920; ++k) {
      const double t_s = 0.02 + 0.002 * k;
      SE3 T = T_base_flange_at(t_s, truth);
      T.translation() += 0.01 * Vec3(normal(random), normal(random), normal(random));
      T.linear() =
          T.linear() * geometry::exp_so3(5e-5 * Vec3(normal(random), normal(random), normal(random)));
      scan.poses.push_back(
          {.stamp = RobotClock::time_point{Nanoseconds{std::llround((t_s + offset_s) * 1e9)}},
           .T_base_flange = T});
    }
    return scan;
  }
};

TEST(ScanSelfConsistency, ClockOffsetIsFoundAndItsUncertaintyHonest) {
  const double offset_s = 3.7e-3;
  const auto found = find_clock_offset(scan_of(offset_s), truth, 6);
  CHECK_TRUE_TEXT(found.has_value(), found ? "" : to_line(found.error()).c_str());
  CHECK(found->determined());
  const double error_s = std::abs(std::chrono::duration<double>(found->offset).count() - offset_s);
  const double sigma_s = std::chrono::duration<double>(found->sigma).count();
  CHECK_TRUE_TEXT(
      error_s < 0.05e-3,
      StringFromFormat("%.4f ms off, sigma %.4f ms", 1e3 * error_s, 1e3 * sigma_s).asCharString());
  CHECK_TRUE_TEXT(
      error_s < 2 * sigma_s + 1e-6,
      StringFromFormat("%.4f ms off, sigma %.4f ms", 1e3 * error_s, 1e3 * sigma_s).asCharString());
  CHECK(found->rms_mm < found->rms_before_mm);
}

TEST(ScanSelfConsistency, NegativeOffsetIsFoundToo) {
  const auto found = find_clock_offset(scan_of(-9.2e-3), truth, 12);
  CHECK(found.has_value());
  DOUBLES_EQUAL(-9.2e-3, std::chrono::duration<double>(found->offset).count(), 0.05e-3);
}

TEST(ScanSelfConsistency, NothingSeenTwiceIsRefused) {
  Scan scan = scan_of(0);
  scan.frames.resize(30);  // one way only
  const auto found = find_clock_offset(scan, truth, 4);
  CHECK_FALSE(found.has_value());
  CHECK(error_row(found.error().code).exit_status == ExitStatus::Refused);
}

TEST(ScanSelfConsistency, SeenTwiceUnderEqualMotionIsNotDetermined) {
  // The same way twice: a point comes out at one and the same wrong place both times.
  Scan scan = scan_of(0);
  const std::size_t once = scan.frames.size() / 3, poses_once = scan.poses.size() / 3;
  scan.frames.resize(once);
  scan.poses.resize(poses_once);
  const Nanoseconds later{20'000'000'000};
  for (std::size_t i = 0; i < once; ++i) {
    scan.frames.push_back(scan.frames[i]);
    scan.frames.back().exposure_mid += later;
  }
  for (std::size_t i = 0; i < poses_once; ++i) {
    scan.poses.push_back(scan.poses[i]);
    scan.poses.back().stamp += later;
    scan.poses.back().T_base_flange.translation() +=
        0.005 * Vec3(normal(random), normal(random), normal(random));
  }
  const auto found = find_clock_offset(scan, truth, 0);
  CHECK_TRUE_TEXT(found.has_value(), found ? "" : to_line(found.error()).c_str());
  CHECK_FALSE(found->determined());
  STRCMP_CONTAINS("different velocities", found->reason.c_str());
  CHECK(std::chrono::duration<double>(found->sigma).count() > 0.5e-3);
}

TEST(ScanSelfConsistency, RefinementOfTheTruthStaysThere) {
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) = Vec3::UnitX();
  axes.col(1) = truth.plane.normal_cam.cross(Vec3::UnitX()).normalized();
  RefineVector sigma;
  sigma << 5e-5, 5e-5, 0.01, 0.02, 0.02, 0.02, 1e-4, 1e-4, 1e-4, 1e-5;
  const auto refined =
      refine_from_scan(scan_of(0), truth, RefineMatrix(sigma.cwiseAbs2().asDiagonal()), axes);
  CHECK_TRUE_TEXT(refined.has_value(), refined ? "" : to_line(refined.error()).c_str());
  CHECK(refined->rms_after_mm <= refined->rms_before_mm);
  // Half of what the calibration knew beforehand, and mostly far less.
  for (int i = 0; i < k_refined; ++i) CHECK(std::abs(refined->change[i]) < 0.5 * sigma[i]);
}

TEST(ScanSelfConsistency, RefinementBringsPlaneAndMountingNearer) {
  const Scan scan = scan_of(0);
  ScanModel start = truth;
  start.T_flange_cam =
      truth.T_flange_cam * geometry::exp_se3((Twist() << 0.08, -0.06, 0.05, 4e-4, -5e-4, 3e-4).finished());
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) = Vec3::UnitX();
  axes.col(1) = start.plane.normal_cam.cross(Vec3::UnitX()).normalized();
  RefineVector sigma;
  sigma << 5e-5, 5e-5, 0.01, 0.1, 0.1, 0.1, 5e-4, 5e-4, 5e-4, 1e-5;
  const auto refined = refine_from_scan(scan, start, RefineMatrix(sigma.cwiseAbs2().asDiagonal()), axes);
  CHECK_TRUE_TEXT(refined.has_value(), refined ? "" : to_line(refined.error()).c_str());
  CHECK_TRUE_TEXT(refined->rms_after_mm < 0.8 * refined->rms_before_mm,
                  StringFromFormat("%.4f before, %.4f after", refined->rms_before_mm, refined->rms_after_mm)
                      .asCharString());
  const double turn_before =
      geometry::angle_between_rad(truth.T_flange_cam.linear(), start.T_flange_cam.linear());
  const double turn_after =
      geometry::angle_between_rad(truth.T_flange_cam.linear(), refined->model.T_flange_cam.linear());
  CHECK(turn_after < 0.5 * turn_before);
}

}  // namespace biteline::calibration
