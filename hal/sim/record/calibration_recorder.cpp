// SPDX-License-Identifier: MIT
#include "hal/sim/record/calibration_recorder.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/config/sensor_yaml.hpp"
#include "common/session/session.hpp"
#include "hal/sim/record/calibration_views.hpp"
#include "hal/sim/record/files.hpp"

namespace biteline::sim {

namespace {

namespace fs = std::filesystem;

constexpr double k_degree = std::numbers::pi / 180;
class Recorder {
 public:
  Recorder(const fs::path& folder, const CalibrationSettings& settings,
           const std::function<void(double)>& progress)
      : folder_(folder),
        settings_(settings),
        progress_(progress),
        head_(draw_head(settings.head_seed)),
        views_(head_, Random(settings.view_seed).fork(1), settings.chessboard_squares),
        noise_(Random(settings.view_seed).fork(2)) {
    head_.model.region = {.offset_u_px = 0,
                          .offset_v_px = 0,
                          .width_px = head_.sensor_width_px,
                          .height_px = head_.sensor_height_px};
    set_light(head_, settings.light);
    head_.model.rate_hz.reset();
    head_.model.exposure.reset();
    // The mean of many exposures is one with as much more light and as much less noise.
    head_.faults.electrons_per_grey *= settings_.averaged;
    head_.faults.read_noise_grey /= std::sqrt(settings_.averaged);
    pictures_ = settings.camera_views + 2 * settings.laser_views + settings.handeye_views;
  }

  Result<void> record() {
    for (const char* part : {"camera", "laser", "handeye", "truth"})
      BITELINE_TRY(make_folder(folder_ / part));
    const auto text_of = [&](const RingGrid& grid) {
      return grid_text(settings_.chessboard_squares > 0 ? grid.as_chessboard(settings_.chessboard_squares)
                                                        : grid);
    };
    BITELINE_TRY(write_file(folder_ / "target.yaml", text_of(RingGrid{})));
    BITELINE_TRY(write_file(folder_ / "laser" / "target.yaml", "planes: 2\n" + text_of(plane_grid())));
    BITELINE_TRY(
        write_file(folder_ / "truth" / "sensor.yaml",
                   config::sensor_yaml_text(
                       head_.model, "made head " + std::to_string(settings_.head_seed) + ", simulated")));
    BITELINE_TRY(record_camera());
    BITELINE_TRY(record_laser());
    BITELINE_TRY(record_handeye());
    return record_clock();
  }

 private:
  static std::string number(int view, const char* ending) {
    char text[40];
    std::snprintf(text, sizeof text, "%02d%s", view, ending);
    return text;
  }

  Result<void> write_picture(const fs::path& file, const image::GreyImage& picture) {
    BITELINE_TRY(image::write_png(file, picture));
    ++written_;
    if (progress_) progress_(static_cast<double>(written_) / pictures_);
    return {};
  }

  Result<void> record_camera() {
    for (int i = 0; i < settings_.camera_views; ++i) {
      const PlacedGrid view = views_.draw_view(40 * k_degree);
      BITELINE_TRY(write_picture(
          folder_ / "camera" / number(i, ".png"),
          render_rings(head_, {&view, 1}, views_.draw_lamp(settings_.scaled_ratio), noise_.next())));
    }
    return {};
  }

  Result<void> record_laser() {
    const double plane_angle_rad = std::numbers::pi / 2 + settings_.plane_angle_error_rad * views_.gaussian();
    for (int i = 0; i < settings_.laser_views; ++i) {
      const auto sheets = views_.draw_two_planes(plane_angle_rad);
      BITELINE_TRY(write_picture(
          folder_ / "laser" / number(i, "_rings.png"),
          render_rings(head_, sheets, views_.draw_lamp(settings_.scaled_ratio), noise_.next())));
      BITELINE_ASSIGN(const Scene scene, Scene::build(mesh_of_sheets(sheets)));
      StripeRenderer renderer(scene, head_);
      image::GreyImage picture{
          .width_px = head_.sensor_width_px, .height_px = head_.sensor_height_px, .pixels = {}};
      picture.pixels.resize(static_cast<std::size_t>(picture.width_px) *
                            static_cast<std::size_t>(picture.height_px));
      renderer.render(
          {.T_scene_cam = SE3::Identity(), .region = head_.model.region, .noise_seed = noise_.next()},
          picture.pixels, nullptr);
      BITELINE_TRY(write_picture(folder_ / "laser" / number(i, "_laser.png"), picture));
    }
    return {};
  }

  Result<void> record_handeye() {
    const SE3 T_base_sheet = views_.draw_table_place();
    std::vector<session::StampedPose> poses;
    for (int i = 0; i < settings_.handeye_views; ++i) {
      const PlacedGrid view = views_.draw_view(32 * k_degree);
      BITELINE_TRY(write_picture(
          folder_ / "handeye" / number(i, ".png"),
          render_rings(head_, {&view, 1}, views_.draw_lamp(settings_.scaled_ratio), noise_.next())));
      const SE3 T_base_flange = T_base_sheet * view.T_cam_sheet.inverse(Eigen::Isometry) *
                                head_.model.T_flange_cam.inverse(Eigen::Isometry);
      Twist error;
      for (int k = 0; k < 3; ++k) {
        error[k] = settings_.pose_noise_mm * noise_.gaussian();
        error[k + 3] = settings_.pose_noise_rad * noise_.gaussian();
      }
      poses.push_back({.stamp = RobotClock::time_point{Nanoseconds{i}},
                       .T_base_flange = T_base_flange * geometry::exp_se3(error)});
    }
    return session::write_pose_table(folder_ / "handeye" / "poses.csv", poses);
  }

  Result<void> record_clock() {
    if (!settings_.clock_offset) return {};
    SceneSettings scene_settings;
    scene_settings.shoe = draw_shoe(ShoeClass::Deep, settings_.view_seed);
    scene_settings.head_seed = settings_.head_seed;
    scene_settings.light = settings_.light;
    BITELINE_ASSIGN(const auto scene, make_scene(scene_settings));
    RecordSettings session;
    session.pose_clock_offset = *settings_.clock_offset;
    session.tell_clock_offset = false;
    session.noise_seed = settings_.view_seed;
    return record_session(folder_ / "clock", *scene, session, progress_);
  }

  fs::path folder_;
  CalibrationSettings settings_;
  const std::function<void(double)>& progress_;
  MadeHead head_;
  CalibrationViews views_;
  Random noise_;
  int pictures_{0}, written_{0};
};

}  // namespace

Result<void> record_calibration(const fs::path& folder, const CalibrationSettings& settings,
                                const std::function<void(double)>& progress) {
  return Recorder(folder, settings, progress).record();
}

}  // namespace biteline::sim
