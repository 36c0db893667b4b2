// SPDX-License-Identifier: MIT
#include "hal/sim/motion/scan_path.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::sim {

TEST_GROUP(ScanPath) {
  Outline outline{{.length_mm = 280}};
  MadeHead head = draw_head(5);
};

TEST(ScanPath, BeamMeetsTheWallHeadOnAndPitchedAllTheWayRound) {
  const ScanPath sut(outline, head, {.target_z_mm = 35, .pitch_rad = 0.1, .lead_mm = 2});
  for (double way_mm = 0; way_mm < sut.length_mm(); way_mm += 11) {
    const SE3 T_shoe_cam = sut.T_shoe_cam_at(way_mm);
    const Vec3 beam = T_shoe_cam.linear() * head.laser.beam_cam;
    const auto place = outline.at(sut.s_at_mm(way_mm));
    DOUBLES_EQUAL(-std::cos(0.1), beam.head<2>().dot(place.normal), 1e-9);
    DOUBLES_EQUAL(-std::sin(0.1), beam.z(), 1e-9);
    // The picture's columns rise with height, and the camera sees the working point on its axis.
    CHECK((T_shoe_cam.linear() * Vec3::UnitX()).z() > 0.9);
    const Vec3 working_point = T_shoe_cam * Vec3(0, 0, head.working_distance_mm);
    DOUBLES_EQUAL(35, working_point.z(), 1e-9);
    DOUBLES_EQUAL(2, (place.point - working_point.head<2>()).norm(), 1e-9);
  }
}

TEST(ScanPath, TurningOverALengthStaysNearTheNormalAndTurnsMoreEvenly) {
  const ScanPath along_normal(outline, head, {}), sut(outline, head, {.turn_over_mm = 100});
  constexpr double k_step_mm = 2;
  const auto beam_at = [&](const ScanPath& path, double way_mm) {
    return Vec3(path.T_shoe_cam_at(way_mm).linear() * head.laser.beam_cam);
  };
  const auto roughest = [&](const ScanPath& path) {
    double most_rad = 0, before_rad = -1;
    for (double way_mm = 0; way_mm < path.length_mm(); way_mm += k_step_mm) {
      const double turn_rad = std::acos(beam_at(path, way_mm).dot(beam_at(path, way_mm + k_step_mm)));
      if (before_rad >= 0) most_rad = std::max(most_rad, std::abs(turn_rad - before_rad));
      before_rad = turn_rad;
    }
    return most_rad;
  };
  CHECK(roughest(sut) < 0.6 * roughest(along_normal));
  for (double way_mm = 0; way_mm < sut.length_mm(); way_mm += k_step_mm) {
    CHECK(beam_at(sut, way_mm).dot(beam_at(along_normal, way_mm)) > std::cos(0.2));
    // The stripe keeps its place on the wall.
    const Vec3 at(0, 0, head.working_distance_mm);
    DOUBLES_EQUAL(0, (sut.T_shoe_cam_at(way_mm) * at - along_normal.T_shoe_cam_at(way_mm) * at).norm(), 1e-9);
  }
}

TEST(ScanPath, GoesRoundOnceWithItsLeadOnBothEnds) {
  const ScanPath sut(outline, head, {.speed_mm_s = 50, .lead_mm = 3});
  DOUBLES_EQUAL(outline.perimeter_mm() + 6, sut.length_mm(), 1e-9);
  DOUBLES_EQUAL(sut.length_mm() / 50, sut.duration_s(), 1e-12);
  const SE3 begin = sut.T_shoe_cam_at(0), again = sut.T_shoe_cam_at(outline.perimeter_mm());
  DOUBLES_EQUAL(0, (begin.translation() - again.translation()).norm(), 1e-6);
}

TEST(ScanPath, ACheckLapTurnsTheHeadWhereTheScanEndsOverItsBeginAndNotHalfWayRound) {
  const ScanPath plain(outline, head, {.lead_mm = 2});
  const ScanPath sut(outline, head, {.lead_mm = 2, .check = {.length_mm = 50}});
  const double middle_mm = sut.length_mm() / 2;
  CHECK(sut.T_shoe_cam_at(middle_mm).isApprox(plain.T_shoe_cam_at(middle_mm), 1e-12));
  double least_rad = 10, most_mm = 0;
  for (double lap_mm = -8; lap_mm <= 32; lap_mm += 8) {
    const SE3 first = sut.T_shoe_cam_at(lap_mm), again = sut.T_shoe_cam_at(outline.perimeter_mm() + lap_mm);
    least_rad = std::min(least_rad, geometry::log_so3(first.linear().transpose() * again.linear()).norm());
    // Both see the place: the stripe reaches 60 mm up and down, and some 12 mm near and far.
    const Vec3 at(0, 0, head.working_distance_mm);
    most_mm = std::max(most_mm, (first * at - again * at).norm());
  }
  CHECK(least_rad > 0.4);
  CHECK(most_mm < 24);
}

TEST(ScanPath, ACheckLapAddsOnlyTheWayThatTheArmsRampsDoNotGoAnyway) {
  const ScanPath quick(outline, head, {.speed_mm_s = 250, .check = {.length_mm = 50}});
  DOUBLES_EQUAL(31.25, ramp_mm(250), 1e-9);
  DOUBLES_EQUAL(outline.perimeter_mm() + 4, quick.length_mm(), 1e-9);
  const ScanPath slow(outline, head, {.speed_mm_s = 50, .check = {.length_mm = 50}});
  DOUBLES_EQUAL(outline.perimeter_mm() + 4 + 50 - 2 * ramp_mm(50), slow.length_mm(), 1e-9);
}

TEST(ScanPath, ACheckLapLiftsTheHeadAndNeverLowersIt) {
  const ScanPath plain(outline, head, {}), sut(outline, head, {.check = {.length_mm = 50}});
  for (double way_mm = 0; way_mm <= sut.length_mm(); way_mm += 5) {
    const double lifted_mm = (sut.T_shoe_cam_at(way_mm) * head.laser.emitter_cam).z() -
                             (plain.T_shoe_cam_at(way_mm) * head.laser.emitter_cam).z();
    CHECK(lifted_mm > -0.5);
  }
}

}  // namespace biteline::sim
