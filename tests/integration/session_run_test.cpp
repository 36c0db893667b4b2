// SPDX-License-Identifier: MIT
// The real sensor program on small made sessions, taken in over the network.
#include "host/intake/session_run.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>

#include "common/config/sensor_yaml.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_session.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::intake {

TEST_GROUP(SessionRun) {
  test::TemporaryFolder folder;
  test::MadeSession made;
  SessionRunOptions options;

  void setup() override {
    options.session = folder.path() / "made";
    test::write_made_session(made, options.session);
  }

  double rms_off_truth_mm(const SessionRun& run) const {
    const geometry::SensorModel sensor = test::made_sensor(made);
    double squares_mm2 = 0;
    for (std::size_t i = 0; i < run.cloud.size(); ++i) {
      const int frame = static_cast<int>(run.cloud.profile[i]);
      const int column = run.cloud.column[i];
      const Vec2 pixel_px{column + sensor.region.offset_u_px,
                          test::made_row_px(made, frame, column) + sensor.region.offset_v_px};
      const Vec3 point_cam = geometry::triangulate(sensor.camera, sensor.laser_plane, pixel_px);
      const Vec3 truth_base = test::made_pose(frame) * sensor.T_flange_cam * point_cam;
      squares_mm2 += (run.cloud.points[i].cast<double>() - truth_base).squaredNorm();
    }
    return std::sqrt(squares_mm2 / static_cast<double>(run.cloud.size()));
  }
};

TEST(SessionRun, EveryFrameArrivesAndEveryPointLiesWhereTheStripeWas) {
  const Result<SessionRun> run = run_sensor_on_session(options);
  SUCCEEDS(run);
  LONGS_EQUAL(made.frames, run->counts.profiles);
  LONGS_EQUAL(made.frames, run->counts.profiles_used);
  LONGS_EQUAL(0, run->counts.profiles_lost);
  // The stripe is in every column; at the region's sides a few may be left out as uncertain.
  CHECK(run->cloud.size() > static_cast<std::size_t>(made.frames * made.width_px * 95 / 100));

  const double rms_mm = rms_off_truth_mm(*run);
  // Peaks of amplitude 180 in noise of 1.5 are good to about 0.03 px (Cramer-Rao with 2.5 px width: 0.02);
  // one pixel is some 0.4 mm along the plane here.  Four times that still is far from any swapped frame or
  // shifted stamp (1 mm).
  constexpr double k_tolerance_mm = 4 * 0.03 * 0.4;
  CHECK_TEXT(rms_mm < k_tolerance_mm, "points off");
}

TEST(SessionRun, TheStripesHeightAndWidthComeAlongWithEachProfileAndInTheCloud) {
  std::size_t live = 0;
  options.on_profile = [&](const profile::Profile&, std::span<const Eigen::Vector3f> points,
                           const cloud::StripeSpan& stripe) {
    LONGS_EQUAL(points.size(), stripe.amplitude.size());
    live += stripe.width_px.size();
  };
  const Result<SessionRun> run = run_sensor_on_session(options);
  SUCCEEDS(run);
  LONGS_EQUAL(run->cloud.size(), live);
  LONGS_EQUAL(run->cloud.size(), run->cloud.amplitude.size());
  // Drawn with 180 grey levels and a standard deviation of 2.5 px.
  for (std::size_t i = 0; i < run->cloud.size(); ++i) {
    DOUBLES_EQUAL(180, run->cloud.amplitude[i], 18);
    DOUBLES_EQUAL(2.5 * 2.355, run->cloud.width_px[i], 0.6);
  }
}

TEST(SessionRun, AnotherCalibrationReplacesTheHeadsOwnAndNotTheRecordings) {
  geometry::SensorModel other = test::made_sensor(made);
  other.T_flange_cam.translation().x() += 100;
  other.region.offset_v_px = 0;
  other.pose_clock_offset = Nanoseconds{0};
  options.sensor_file = folder.write("other.yaml", config::sensor_yaml_text(other, "another head"));
  const Result<SessionRun> run = run_sensor_on_session(options);
  SUCCEEDS(run);
  DOUBLES_EQUAL(other.T_flange_cam.translation().x(), run->sensor.model.T_flange_cam.translation().x(), 1e-9);
  LONGS_EQUAL(80, run->sensor.model.region.offset_v_px);
  LONGS_EQUAL(7'000'000, run->sensor.model.pose_clock_offset.count());
}

TEST(SessionRun, PeaksAreFoundAsTheSensorIsTold) {
  const Result<SessionRun> matched = run_sensor_on_session(options);
  SUCCEEDS(matched);
  options.sensor_options = {"--peak-mode", "maximum", "--peak", "strongest", "--peak-threshold", "20"};
  const Result<SessionRun> maximum = run_sensor_on_session(options);
  SUCCEEDS(maximum);
  // The brightest pixel and its neighbours know less than the whole shape.
  CHECK(rms_off_truth_mm(*maximum) > 1.2 * rms_off_truth_mm(*matched));
  CHECK(rms_off_truth_mm(*maximum) < 0.2);
  options.sensor_options = {"--peak-mode", "guess"};
  FAILS_NAMING(Errc::BadFormat, "--peak-mode", run_sensor_on_session(options));
}

TEST(SessionRun, FaultOfTheSessionIsToldAsItself) {
  options.session = folder.path() / "nowhere";
  FAILS_NAMING(Errc::FileNotFound, "nowhere", run_sensor_on_session(options));
}

TEST(SessionRun, BrokenPictureIsNamed) {
  const auto session = session::read_session(options.session);
  SUCCEEDS(session);
  std::ofstream{session->frames[5].file} << "no picture";
  const Result<SessionRun> run = run_sensor_on_session(options);
  CHECK(!run);
  STRCMP_CONTAINS(session->frames[5].file.filename().c_str(), to_line(run.error()).c_str());
  LONGS_EQUAL(static_cast<int>(ExitStatus::BadInput),
              static_cast<int>(error_row(run.error().code).exit_status));
}

TEST(SessionRun, MissingSensorProgramIsNamed) {
  options.program = folder.path() / "no-such-program";
  FAILS_NAMING(Errc::FileNotFound, "no-such-program", run_sensor_on_session(options));
}

TEST(SessionRun, ProgramThatDiesIsToldWithItsLastWords) {
  options.program = folder.write("dies", "#!/bin/sh\necho something is very wrong >&2\nexit 4\n");
  std::filesystem::permissions(*options.program, std::filesystem::perms::owner_all);
  FAILS_NAMING(Errc::ProcessDied, "something is very wrong", run_sensor_on_session(options));
}

}  // namespace biteline::intake
