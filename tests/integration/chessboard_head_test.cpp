// SPDX-License-Identifier: MIT
// A whole head by chessboards alone: the simulated cell's pictures of them, `biteline calibrate`, the truth.
#include <CppUTest/TestHarness.h>

#include <nlohmann/json.hpp>

#include "common/config/sensor_yaml.hpp"
#include "hal/sim/record/calibration_recorder.hpp"
#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

using namespace std::chrono_literals;

TEST_GROUP(ChessboardHead) {
  test::TemporaryFolder folder;
};

TEST(ChessboardHead, IsCalibratedAndItsPointsLieWhereTheTruthPutsThem) {
  sim::CalibrationSettings settings;
  settings.camera_views = 8;
  settings.laser_views = 4;
  settings.handeye_views = 9;
  settings.chessboard_squares = 2;
  const auto calib = folder.path() / "calib", out = folder.path() / "out";
  SUCCEEDS(sim::record_calibration(calib, settings, {}));
  auto child = intake::ChildProcess::start(
      {.program = BITELINE_TOOL, .arguments = {"calibrate", calib.string(), "--out", out.string()}});
  SUCCEEDS(child);
  LONGS_EQUAL(0, *child->wait(300s));
  const auto truth = config::read_sensor_yaml(calib / "truth/sensor.yaml"),
             found = config::read_sensor_yaml(out / "sensor.yaml");
  SUCCEEDS(truth);
  SUCCEEDS(found);
  DOUBLES_EQUAL(1.0, found->camera.fu_px / truth->camera.fu_px, 1e-3);
  double most_mm = 0;
  for (int u = 50; u < 1600; u += 50) {
    for (int v = 470; v < 780; v += 20) {
      const Vec3 is = truth->T_flange_cam *
                      geometry::triangulate(truth->camera, truth->laser_plane, Vec2(u, v)),
                 seen = found->T_flange_cam *
                        geometry::triangulate(found->camera, found->laser_plane, Vec2(u, v));
      most_mm = std::max(most_mm, (seen - is).norm());
    }
  }
  // Robot poses are good to 0.02 mm and 0.1 mrad, 350 mm from the flange.
  CHECK_TRUE_TEXT(most_mm < 0.1, StringFromFormat("%.3f mm", most_mm).asCharString());
  std::ifstream in(out / "report.json");
  const auto report = test::read_json(in);
  LONGS_EQUAL(0, report["set_aside"].size());
  // Two readings of these boards (even by even squares) are told apart by the arm's poses.
  LONGS_EQUAL(9, report["hand_eye"]["views"].size());
  CHECK(report["camera"]["rms_px"].get<double>() < 0.1);
}

}  // namespace biteline
