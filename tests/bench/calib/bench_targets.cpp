// SPDX-License-Identifier: MIT
// What a chessboard costs in place of rings: the same heads, the same views, other marks.
//     bench_targets [heads] [folder]
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "common/config/sensor_yaml.hpp"
#include "hal/sim/record/calibration_recorder.hpp"
#include "host/calibration/head/head_calibration.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::bench {
namespace {

struct Target {
  const char* name;
  int squares;  ///< from one ring's centre to the next; 0: rings
};
constexpr std::array k_targets{Target{"rings, 28 of 12 mm", 0},
                               Target{"chessboard, 28 corners, squares 14 mm", 1},
                               Target{"chessboard, 91 corners, squares 7 mm", 2}};

/// Mean squares over the heads.
struct Errors {
  double focal_percent2{0}, middle_px2{0}, in_camera_mm2{0}, on_flange_mm2{0}, rms_px2{0};
  int heads{0};

  void add(const calibration::HeadCalibration& head, const geometry::SensorModel& truth) {
    const calibration::HeadState& state = head.fit.state;
    focal_percent2 += std::pow(100 * (state.camera.fu_px / truth.camera.fu_px - 1), 2);
    middle_px2 +=
        (Vec2(state.camera.cu_px, state.camera.cv_px) - Vec2(truth.camera.cu_px, truth.camera.cv_px))
            .squaredNorm();
    double camera_mm2 = 0, flange_mm2 = 0;
    int points = 0;
    // Where the stripe lies on shoes.
    for (int u = 50; u < 1600; u += 50) {
      for (int v = 470; v < 780; v += 20) {
        const Vec3 seen = geometry::triangulate(state.camera, state.plane, Vec2(u, v)),
                   is = geometry::triangulate(truth.camera, truth.laser_plane, Vec2(u, v));
        camera_mm2 += (seen - is).squaredNorm();
        flange_mm2 += (state.T_flange_cam * seen - truth.T_flange_cam * is).squaredNorm();
        ++points;
      }
    }
    in_camera_mm2 += camera_mm2 / points;
    on_flange_mm2 += flange_mm2 / points;
    rms_px2 += head.fit.rms_px * head.fit.rms_px;
    ++heads;
  }
  [[nodiscard]] double rms(double Errors::*sum) const { return std::sqrt(this->*sum / heads); }
};

Result<void> calibrate(const std::filesystem::path& folder, Errors& errors) {
  calibration::HeadInput input;
  BITELINE_ASSIGN(input.camera, calibration::read_camera_folder(folder));
  BITELINE_ASSIGN(input.laser, calibration::read_laser_folder(folder));
  BITELINE_ASSIGN(input.hand_eye, calibration::read_hand_eye_folder(folder));
  BITELINE_ASSIGN(const geometry::SensorModel truth, config::read_sensor_yaml(folder / "truth/sensor.yaml"));
  const calibration::HeadCalibration head = calibration::calibrate_head(input);
  if (head.refused) return tl::unexpected<Error>(*head.refused);
  errors.add(head, truth);
  return {};
}

Result<void> run(int heads, const std::filesystem::path& folder) {
  std::array<Errors, k_targets.size()> errors;
  for (int head = 0; head < heads; ++head) {
    for (std::size_t i = 0; i < k_targets.size(); ++i) {
      sim::CalibrationSettings settings;
      settings.head_seed = 21 + static_cast<std::uint64_t>(head);
      settings.view_seed = 1 + static_cast<std::uint64_t>(head);
      settings.chessboard_squares = k_targets[i].squares;
      const std::filesystem::path calib =
          folder / std::to_string(head) / std::to_string(settings.chessboard_squares);
      BITELINE_TRY(sim::record_calibration(calib, settings, {}));
      BITELINE_TRY(calibrate(calib, errors[i]));
    }
  }
  struct Figure {
    const char* words;
    double Errors::*sum;
    const char* unit;
  };
  constexpr std::array k_figures{
      Figure{"marks off their places in the picture", &Errors::rms_px2, "px"},
      Figure{"focal length, error", &Errors::focal_percent2, "%"},
      Figure{"principal point, error", &Errors::middle_px2, "px"},
      Figure{"point of the stripe in the camera's frame, error", &Errors::in_camera_mm2, "mm"},
      Figure{"point of the stripe on the flange, error", &Errors::on_flange_mm2, "mm"}};
  for (const Figure& figure : k_figures) {
    const double rings = errors[0].rms(figure.sum);
    for (std::size_t i = 1; i < k_targets.size(); ++i) {
      const double board = errors[i].rms(figure.sum);
      std::printf(
          "{\"bench\":\"calib.targets\",\"what\":\"%s, RMS of %d heads\",\"ours\":%.5g,\"peer\":\"%s\","
          "\"peer_value\":%.5g,\"unit\":\"%s\",\"ratio\":%.4g,\"target\":%g}\n",
          figure.words, heads, rings, k_targets[i].name, board, figure.unit, rings / board, 1.5);
    }
  }
  return {};
}

}  // namespace
}  // namespace biteline::bench

int main(int count, char** words) {
  const int heads = count > 1 ? std::atoi(words[1]) : 2;
  if (heads < 1) {
    std::fprintf(stderr, "bench_targets [heads] [folder]: heads from 1 on expected\n");
    return 2;
  }
  const biteline::test::TemporaryFolder folder;
  const auto done = biteline::bench::run(heads, count > 2 ? std::filesystem::path(words[2]) : folder.path());
  if (!done) std::fprintf(stderr, "bench_targets: %s\n", biteline::to_line(done.error()).c_str());
  return done ? 0 : 1;
}
