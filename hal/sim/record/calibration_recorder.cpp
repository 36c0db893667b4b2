// SPDX-License-Identifier: MIT
#include "hal/sim/record/calibration_recorder.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/config/sensor_yaml.hpp"
#include "common/session/session.hpp"
#include "hal/sim/record/files.hpp"
#include "hal/sim/record/ring_target.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

namespace fs = std::filesystem;

constexpr double k_degree = std::numbers::pi / 180;
constexpr double k_ring_margin_px = 15;
/// Draws of a view before the next smaller tilt is tried.
constexpr int k_most_draws = 2000;

RingGrid plane_grid() {
  return {.rows = 4, .cols = 3};
}

/// Half of the gap between the two sheets of the laser target's edge.
constexpr double k_ridge_gap_mm = 1.2;

class Recorder {
 public:
  Recorder(const fs::path& folder, const CalibrationSettings& settings,
           const std::function<void(double)>& progress)
      : folder_(folder),
        settings_(settings),
        progress_(progress),
        head_(draw_head(settings.head_seed)),
        views_(Random(settings.view_seed).fork(1)),
        noise_(Random(settings.view_seed).fork(2)) {
    head_.model.region = {.offset_u_px = 0,
                          .offset_v_px = 0,
                          .width_px = head_.sensor_width_px,
                          .height_px = head_.sensor_height_px};
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
    BITELINE_TRY(write_file(folder_ / "target.yaml", grid_text(RingGrid{})));
    BITELINE_TRY(write_file(folder_ / "laser" / "target.yaml", "planes: 2\n" + grid_text(plane_grid())));
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
  static std::string grid_text(const RingGrid& grid) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "rows: %d\ncols: %d\npitch: %.1f\nouter_diameter: %.1f\ninner_diameter: %.1f\n", grid.rows,
                  grid.cols, grid.pitch_mm, grid.outer_diameter_mm, grid.inner_diameter_mm);
    return text;
  }
  static std::string number(int view, const char* ending) {
    char text[40];
    std::snprintf(text, sizeof text, "%02d%s", view, ending);
    return text;
  }

  Result<void> write_picture(const fs::path& file, const image::GreyImage& picture) {
    BITELINE_TRY(image::write_png(file, picture, image::Packing::Small));
    ++written_;
    if (progress_) progress_(static_cast<double>(written_) / pictures_);
    return {};
  }

  LampLight draw_lamp() {
    return {.white_grey = views_.uniform({170, 225}),
            .slope_ratio = views_.uniform({0.1, 0.5}),
            .slope_rad = views_.uniform({-3, 3}),
            .scaled_ratio = settings_.scaled_ratio};
  }

  /// A sheet somewhere in the field, tilted up to `tilt_rad`, every ring in the picture.
  PlacedGrid draw_view(double tilt_rad) {
    for (;; tilt_rad *= 0.9) {
      for (int draw = 0; draw < k_most_draws; ++draw) {
        const double direction_rad = views_.uniform({0, 2 * std::numbers::pi}),
                     tilt = tilt_rad * std::sqrt(views_.uniform({0.1, 1}));
        const Mat3 R = geometry::exp_so3(Vec3(0, 0, views_.uniform({-0.5, 0.5}))) *
                       geometry::exp_so3(tilt * Vec3(std::cos(direction_rad), std::sin(direction_rad), 0));
        const Vec3 place(views_.uniform({-25, 25}), views_.uniform({-22, 22}), views_.uniform({190, 270}));
        const PlacedGrid view{.grid = {}, .T_cam_sheet = geometry::make_se3(Eigen::Quaterniond(R), place)};
        if (all_rings_visible(head_, view, k_ring_margin_px)) return view;
      }
    }
  }

  Result<void> record_camera() {
    for (int i = 0; i < settings_.camera_views; ++i) {
      const PlacedGrid view = draw_view(40 * k_degree);
      BITELINE_TRY(write_picture(folder_ / "camera" / number(i, ".png"),
                                 render_rings(head_, {&view, 1}, draw_lamp(), noise_.next())));
    }
    return {};
  }

  /// The two sheets meet in an upright ridge towards the camera, each turned away by half their angle.
  std::array<PlacedGrid, 2> draw_two_planes(double plane_angle_rad) {
    for (;;) {
      const Mat3 R = geometry::exp_so3(Vec3(0, 0, views_.uniform({-0.25, 0.25}))) *
                     geometry::exp_so3(Vec3(views_.uniform({-0.2, 0.2}), views_.uniform({-0.2, 0.2}), 0));
      const SE3 T_cam_ridge = geometry::make_se3(
          Eigen::Quaterniond(R),
          {views_.uniform({-10, 10}), views_.uniform({-8, 8}), views_.uniform({165, 205})});
      std::array<PlacedGrid, 2> sheets;
      for (int side = 0; side < 2; ++side) {
        const double sign = side == 0 ? -1 : 1;
        const double turn_rad = sign * (std::numbers::pi - plane_angle_rad) / 2;
        SE3 T_ridge_sheet = SE3::Identity();
        T_ridge_sheet.linear() = geometry::exp_so3(Vec3(0, -turn_rad, 0));
        T_ridge_sheet.translation() =
            T_ridge_sheet.linear() * Vec3(sign * (plane_grid().width_mm() / 2 + k_ridge_gap_mm), 0, 0);
        sheets[static_cast<std::size_t>(side)] = {.grid = plane_grid(),
                                                  .T_cam_sheet = T_cam_ridge * T_ridge_sheet};
      }
      if (all_rings_visible(head_, sheets[0], k_ring_margin_px) &&
          all_rings_visible(head_, sheets[1], k_ring_margin_px))
        return sheets;
    }
  }

  Result<void> record_laser() {
    const double plane_angle_rad = std::numbers::pi / 2 + settings_.plane_angle_error_rad * views_.gaussian();
    for (int i = 0; i < settings_.laser_views; ++i) {
      const auto sheets = draw_two_planes(plane_angle_rad);
      BITELINE_TRY(write_picture(folder_ / "laser" / number(i, "_rings.png"),
                                 render_rings(head_, sheets, draw_lamp(), noise_.next())));
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

  static SurfaceMesh mesh_of_sheets(std::span<const PlacedGrid> sheets) {
    SurfaceMesh mesh;
    for (const auto& sheet : sheets) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      const double x = sheet.grid.width_mm() / 2, y = sheet.grid.height_mm() / 2;
      for (const Vec3& corner : {Vec3(-x, -y, 0), Vec3(x, -y, 0), Vec3(x, y, 0), Vec3(-x, y, 0)}) {
        const Eigen::Vector3f p = (sheet.T_cam_sheet * corner).cast<float>();
        mesh.vertices.push_back({p.x(), p.y(), p.z()});
        mesh.looks.push_back({.diffuse_ratio = 0.8, .glossy = false});
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
    return mesh;
  }

  Result<void> record_handeye() {
    // The grid lies on the table, its z down, so that the camera looks along it.
    const SE3 T_base_sheet =
        geometry::make_se3(Eigen::Quaterniond(geometry::exp_so3(Vec3(0, 0, views_.uniform({-0.3, 0.3}))) *
                                              geometry::exp_so3(Vec3(std::numbers::pi, 0, 0))),
                           {views_.uniform({400, 480}), views_.uniform({-60, 60}), views_.uniform({0, 40})});
    std::vector<session::StampedPose> poses;
    for (int i = 0; i < settings_.handeye_views; ++i) {
      const PlacedGrid view = draw_view(32 * k_degree);
      BITELINE_TRY(write_picture(folder_ / "handeye" / number(i, ".png"),
                                 render_rings(head_, {&view, 1}, draw_lamp(), noise_.next())));
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
  Random views_, noise_;
  int pictures_{0}, written_{0};
};

}  // namespace

Result<void> record_calibration(const fs::path& folder, const CalibrationSettings& settings,
                                const std::function<void(double)>& progress) {
  return Recorder(folder, settings, progress).record();
}

}  // namespace biteline::sim
