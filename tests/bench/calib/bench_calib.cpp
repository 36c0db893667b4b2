// SPDX-License-Identifier: MIT
// Calibration beside OpenCV, on the same made pictures with known truth: ring centres, camera, hand-eye.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/config/sensor_yaml.hpp"
#include "host/calibration/camera/camera_calibration.hpp"
#include "host/calibration/camera/plane_pose.hpp"
#include "host/calibration/handeye/hand_eye.hpp"
#include "host/calibration/head/head_calibration.hpp"
#include "host/calibration/rings/picture.hpp"
#include "tests/bench/calib/peer_opencv.hpp"
#include "tests/support/ring_scene.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::bench {
namespace {

constexpr double k_degree = std::numbers::pi / 180;

struct Row {
  const char* bench;
  std::string what;
  double ours;
  const char* peer;
  double peer_value;
  const char* unit;
  double target{1};  ///< largest wanted ratio
};

void print(const Row& row) {
  std::printf(
      "{\"bench\":\"calib.%s\",\"what\":\"%s\",\"ours\":%.5g,\"peer\":\"%s\",\"peer_value\":%.5g,\"unit\":\"%"
      "s\",\"ratio\":%.4g,\"target\":%g}\n",
      row.bench, row.what.c_str(), row.ours, row.peer, row.peer_value, row.unit, row.ours / row.peer_value,
      row.target);
  std::fflush(stdout);
}

/// Squared errors of centres against the projected truth, in the better of the two numberings.
double centre_error_px2(const test::RingScene& scene, const SE3& T_cam_target,
                        const std::vector<Vec2>& centres) {
  const auto sum = [&](bool turned) {
    double error = 0;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      const auto k = static_cast<int>(turned ? centres.size() - 1 - i : i);
      const Vec3 place = scene.target.ring_target(k / scene.target.cols, k % scene.target.cols);
      error += (scene.camera.project(T_cam_target * place) - centres[i]).squaredNorm();
    }
    return error;
  };
  return std::min(sum(false), sum(true));
}

std::vector<Vec2> centres_of(const calibration::PlaneView& view) {
  std::vector<Vec2> centres;
  for (const calibration::CentreObservation& c : view.centres) centres.push_back(c.pixel_px);
  return centres;
}

/// Why: the image of a circle's centre is not the centre of its image.  Without noise, all of the error is
/// bias.
void bench_centre_bias(std::mt19937_64& random) {
  test::RingScene scene;
  for (const double tilt_deg : {0.0, 20.0, 45.0}) {
    const SE3 T = test::T_cam_target_of(
        scene.target, {.distance_mm = 190, .tilt_rad = tilt_deg * k_degree, .tilt_axis_rad = 0.9});
    const image::GreyImage picture = test::draw_rings(
        scene, {T}, {.noise_grey = 0, .blur_px = 0.7, .samples = 6, .light = {}, .covered = {}}, random);
    const auto grids = calibration::find_grids(picture, scene.target, 1);
    const auto peer = opencv_grid(picture, scene.target);
    if (grids.empty() || !peer) continue;
    calibration::PlaneView view = calibration::make_plane_view("", grids[0], scene.target);
    const auto pose = calibration::fit_plane_pose(scene.camera, view.centres);
    calibration::improve_centres(view, scene.camera, pose->T_cam_target);
    const double n = scene.target.rings();
    print({"centre_bias",
           "ring centres without noise, tilt " + std::to_string(static_cast<int>(tilt_deg)) + " deg, RMS",
           std::sqrt(centre_error_px2(scene, T, centres_of(view)) / n), "OpenCV findCirclesGrid",
           std::sqrt(centre_error_px2(scene, T, *peer) / n), "px"});
  }
}

/// Whole chain on pictures with noise, blur and uneven light.
void bench_camera(std::mt19937_64& random) {
  test::RingScene scene;
  constexpr int k_draws = 3, k_views = 10;
  double focal[2] = {0, 0}, middle[2] = {0, 0}, rms[2] = {0, 0};
  int found[2] = {0, 0};
  for (int draw = 0; draw < k_draws; ++draw) {
    std::vector<calibration::PlaneView> ours;
    std::vector<std::vector<Vec2>> theirs;
    for (const test::ViewPlace& place : test::varied_places(k_views, random)) {
      const test::PictureOptions options{.noise_grey = 2,
                                         .blur_px = 1,
                                         .samples = 2,
                                         .light = [](double u, double v) { return 0.6 + 0.4 * u - 0.2 * v; },
                                         .covered = {}};
      const image::GreyImage picture =
          test::draw_rings(scene, {test::T_cam_target_of(scene.target, place)}, options, random);
      const auto grids = calibration::find_grids(picture, scene.target, 1);
      if (!grids.empty())
        ours.push_back(calibration::make_plane_view(std::to_string(ours.size()), grids[0], scene.target));
      if (const auto peer = opencv_grid(picture, scene.target)) theirs.push_back(*peer);
    }
    found[0] += static_cast<int>(ours.size());
    found[1] += static_cast<int>(theirs.size());
    const auto own = calibration::calibrate_camera(ours, scene.size);
    if (!own || theirs.size() < 3) continue;
    const OpencvCamera peer = opencv_camera(theirs, scene.target, scene.size);
    const geometry::Camera cameras[2] = {own->camera, peer.camera};
    for (int i = 0; i < 2; ++i) {
      focal[i] += std::pow(100 * (cameras[i].fu_px / scene.camera.fu_px - 1), 2) / k_draws;
      middle[i] += (Vec2(cameras[i].cu_px, cameras[i].cv_px) - Vec2(scene.camera.cu_px, scene.camera.cv_px))
                       .squaredNorm() /
                   k_draws;
    }
    rms[0] += own->rms_px / k_draws;
    rms[1] += peer.rms_px / k_draws;
  }
  print({"camera", "pictures in which the grid is not found, of 30, and 1",
         1.0 + k_draws * k_views - found[0], "OpenCV findCirclesGrid", 1.0 + k_draws * k_views - found[1],
         ""});
  print({"camera", "focal length, RMS error", std::sqrt(focal[0]), "OpenCV calibrateCamera",
         std::sqrt(focal[1]), "%"});
  print({"camera", "principal point, RMS error", std::sqrt(middle[0]), "OpenCV calibrateCamera",
         std::sqrt(middle[1]), "px"});
  print({"camera", "reprojection RMS", rms[0], "OpenCV calibrateCamera", rms[1], "px"});
}

/// 50 noise draws: 20 um and 0.1 mrad per robot pose, 0.036 px per ring centre.
void bench_hand_eye(std::mt19937_64& random) {
  constexpr int k_draws = 50, k_stops = 13;
  constexpr double k_pose_mm = 0.02, k_pose_rad = 1e-4, k_centre_px = 0.036;
  test::RingScene scene;
  std::normal_distribution<double> normal(0, 1);
  const auto noise = [&](double sigma) {
    return Vec3(sigma * Vec3(normal(random), normal(random), normal(random)));
  };
  SE3 T_flange_cam = SE3::Identity(), T_base_target = SE3::Identity();
  T_flange_cam.linear() = Eigen::AngleAxisd(0.77, Vec3::UnitX()).toRotationMatrix();
  T_flange_cam.translation() = Vec3(10, 153, 251);
  T_base_target.linear() = Eigen::AngleAxisd(3.0, Vec3(1, 0.05, 0.02).normalized()).toRotationMatrix();
  T_base_target.translation() = Vec3(400, 100, 20);
  double own_mm2 = 0, own_rad2 = 0, bound_mm2 = 0, bound_rad2 = 0, peer_mm2[k_hand_eye_methods] = {},
         peer_rad2[k_hand_eye_methods] = {};
  for (int draw = 0; draw < k_draws; ++draw) {
    std::vector<calibration::HandEyeView> views;
    std::vector<calibration::Stop> stops;
    for (const test::ViewPlace& place : test::varied_places(k_stops, random)) {
      const SE3 T_cam_target = test::T_cam_target_of(scene.target, place);
      SE3 T_base_flange = T_base_target * (T_flange_cam * T_cam_target).inverse();
      T_base_flange.translation() += noise(k_pose_mm);
      T_base_flange.linear() = T_base_flange.linear() * geometry::exp_so3(noise(k_pose_rad));
      const auto pose = calibration::fit_plane_pose(
          scene.camera, test::exact_view(scene, T_cam_target, "", k_centre_px, random).centres);
      views.push_back(
          {.name = "", .T_base_flange = T_base_flange, .pose = *pose, .readings = {calibration::Reading{}}});
      stops.push_back({.T_base_flange = T_base_flange, .T_cam_target = pose->T_cam_target});
    }
    const auto own = calibration::calibrate_hand_eye(
        views, {.centre_sigma_px = k_centre_px, .middle_target = scene.target.middle_target()});
    if (!own) continue;
    const auto add = [&](const SE3& T, double& mm2, double& rad2) {
      mm2 += (T.translation() - T_flange_cam.translation()).squaredNorm() / k_draws;
      rad2 += std::pow(geometry::angle_between_rad(T.linear(), T_flange_cam.linear()), 2) / k_draws;
    };
    add(own->T_flange_cam, own_mm2, own_rad2);
    bound_mm2 += own->covariance.topLeftCorner<3, 3>().trace() / k_draws;
    bound_rad2 += own->covariance.bottomRightCorner<3, 3>().trace() / k_draws;
    for (int m = 0; m < k_hand_eye_methods; ++m) add(opencv_hand_eye(stops, m), peer_mm2[m], peer_rad2[m]);
  }
  for (int m = 0; m < k_hand_eye_methods; ++m) {
    print({"hand_eye", "T_flange_cam, 50 noise draws, RMS", std::sqrt(own_mm2), hand_eye_name(m),
           std::sqrt(peer_mm2[m]), "mm"});
    print({"hand_eye", "T_flange_cam, 50 noise draws, RMS", std::sqrt(own_rad2) / k_degree, hand_eye_name(m),
           std::sqrt(peer_rad2[m]) / k_degree, "deg"});
  }
  print({"hand_eye", "T_flange_cam, 50 noise draws, RMS", std::sqrt(own_mm2), "Cramer-Rao bound",
         std::sqrt(bound_mm2), "mm", 1.3});
  print({"hand_eye", "T_flange_cam, 50 noise draws, RMS", std::sqrt(own_rad2) / k_degree, "Cramer-Rao bound",
         std::sqrt(bound_rad2) / k_degree, "deg", 1.3});
}

/// Centres the other way round: the same grid, read from its other end.
std::vector<Vec2> turned(std::vector<Vec2> centres) {
  std::reverse(centres.begin(), centres.end());
  return centres;
}

/// The reference head's own pictures and truth, where they are at hand.
void bench_reference_head() {
  const auto folder = test::shared_data("calib/head21");
  if (!folder) return;
  const auto truth = config::read_sensor_yaml(*folder / "truth/sensor.yaml");
  calibration::HeadInput input;
  input.camera = *calibration::read_camera_folder(*folder);
  input.laser = *calibration::read_laser_folder(*folder);
  input.hand_eye = *calibration::read_hand_eye_folder(*folder);
  const calibration::HeadCalibration ours = calibration::calibrate_head(input);
  if (!truth || ours.refused) return;
  const calibration::RingTarget& target = input.camera->target;

  std::vector<std::vector<Vec2>> views;
  for (const calibration::PlaneView& view : input.camera->views) {
    if (const auto centres = opencv_grid(*calibration::read_picture(*folder / view.name), target))
      views.push_back(*centres);
  }
  const OpencvCamera peer = opencv_camera(views, target, input.camera->size);
  const geometry::Camera &own = ours.fit.state.camera, &exact = truth->camera;
  const auto focal = [&](const geometry::Camera& c) { return 100 * std::abs(c.fu_px / exact.fu_px - 1); };
  const auto middle = [&](const geometry::Camera& c) {
    return std::hypot(c.cu_px - exact.cu_px, c.cv_px - exact.cv_px);
  };
  const char* name = "OpenCV calibrateCamera";
  print({"head21", "focal length, error", focal(own), name, focal(peer.camera), "%"});
  print({"head21", "principal point, error", middle(own), name, middle(peer.camera), "px"});
  print({"head21", "reprojection RMS", ours.fit.rms_px, name, peer.rms_px, "px"});

  // OpenCV numbers a grid from either end; it is given the end that fits.
  std::vector<calibration::Stop> stops;
  for (std::size_t i = 0; i < ours.arm_views.size(); ++i) {
    const calibration::ArmPicture& picture = ours.arm_views[i];
    const auto centres = opencv_grid(*calibration::read_picture(*folder / picture.view.name), target);
    if (!centres) continue;
    const SE3& seen = ours.hand_eye->stops[i].T_cam_target;
    SE3 T_cam_target = opencv_pose(peer.camera, *centres, target);
    if (geometry::angle_between_rad(T_cam_target.linear(), seen.linear()) > 1)
      T_cam_target = opencv_pose(peer.camera, turned(*centres), target);
    stops.push_back({.T_base_flange = picture.T_base_flange, .T_cam_target = T_cam_target});
  }
  const auto mm = [&](const SE3& T) { return (T.translation() - truth->T_flange_cam.translation()).norm(); };
  const auto deg = [&](const SE3& T) {
    return geometry::angle_between_rad(T.linear(), truth->T_flange_cam.linear()) / k_degree;
  };
  const SE3& T_own = ours.fit.state.T_flange_cam;
  for (int m = 0; m < k_hand_eye_methods; ++m) {
    const SE3 T = opencv_hand_eye(stops, m);
    print({"head21", "T_flange_cam, error", mm(T_own), hand_eye_name(m), mm(T), "mm"});
    print({"head21", "T_flange_cam, error", deg(T_own), hand_eye_name(m), deg(T), "deg"});
  }
}

}  // namespace
}  // namespace biteline::bench

int main() {
  std::mt19937_64 random{7};
  biteline::bench::bench_centre_bias(random);
  biteline::bench::bench_camera(random);
  biteline::bench::bench_hand_eye(random);
  biteline::bench::bench_reference_head();
}
