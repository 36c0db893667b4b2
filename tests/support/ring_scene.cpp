// SPDX-License-Identifier: MIT
#include "tests/support/ring_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace biteline::test {

namespace {

constexpr double k_dark_grey = 30, k_bright_grey = 170, k_background_grey = 60, k_cover_grey = 45;

double target_level(const RingScene& scene, const Vec2& place, const PictureOptions& options) {
  const calibration::RingTarget& t = scene.target;
  // Of a chessboard one square lies beyond the outermost corners.
  const double margin_mm = t.chessboard() ? 1.5 * t.pitch_mm : t.pitch_mm;
  if (place.x() < -margin_mm || place.y() < -margin_mm || place.x() > (t.cols - 1) * t.pitch_mm + margin_mm ||
      place.y() > (t.rows - 1) * t.pitch_mm + margin_mm) {
    return -1;
  }
  if (options.covered && options.covered(place)) return k_cover_grey;
  if (t.chessboard()) {
    const double square_col = std::floor(place.x() / t.pitch_mm) + 1,
                 square_row = std::floor(place.y() / t.pitch_mm) + 1;
    if (square_col < 0 || square_row < 0 || square_col > t.cols || square_row > t.rows) return k_bright_grey;
    const bool as_first = std::fmod(square_col + square_row, 2) == 0;
    return as_first == t.first_is_white ? k_bright_grey : k_dark_grey;
  }
  const double col = std::clamp(std::round(place.x() / t.pitch_mm), 0.0, t.cols - 1.0);
  const double row = std::clamp(std::round(place.y() / t.pitch_mm), 0.0, t.rows - 1.0);
  const double radius_mm = (place - Vec2(col, row) * t.pitch_mm).norm();
  return radius_mm < t.outer_diameter_mm / 2 && radius_mm > t.inner_diameter_mm / 2 ? k_dark_grey
                                                                                    : k_bright_grey;
}

/// Place within a pixel of one of `side` x `side` samples.  A board's straight edges run along rows of
/// samples for many pixels, so that none of its samples share a row or column.
std::pair<double, double> sample_of(bool chessboard, int index, int side) {
  if (!chessboard) {
    const int row = index / side;
    return {(index % side + 0.5) / side - 0.5, (row + 0.5) / side - 0.5};
  }
  const double along = index * 0.6180339887 + 0.25;
  return {(index + 0.5) / (side * side) - 0.5, along - std::floor(along) - 0.5};
}

void blur(std::vector<double>& levels, int width, int height, double sigma_px) {
  if (sigma_px <= 0) return;
  const int reach = static_cast<int>(std::ceil(3 * sigma_px));
  std::vector<double> kernel;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i)
    sum += kernel.emplace_back(std::exp(-0.5 * i * i / (sigma_px * sigma_px)));
  for (const bool along_u : {true, false}) {
    const std::vector<double> source = levels;
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        double level = 0;
        for (int i = -reach; i <= reach; ++i) {
          const int uu = along_u ? std::clamp(u + i, 0, width - 1) : u,
                    vv = along_u ? v : std::clamp(v + i, 0, height - 1);
          level +=
              kernel[static_cast<std::size_t>(i + reach)] * source[static_cast<std::size_t>(vv * width + uu)];
        }
        levels[static_cast<std::size_t>(v * width + u)] = level / sum;
      }
    }
  }
}

}  // namespace

SE3 T_cam_target_of(const calibration::RingTarget& target, const ViewPlace& place) {
  SE3 T_cam_middle = SE3::Identity();
  T_cam_middle.translation() = Vec3(place.shift_mm.x(), place.shift_mm.y(), place.distance_mm);
  const Vec3 axis(std::cos(place.tilt_axis_rad), std::sin(place.tilt_axis_rad), 0);
  T_cam_middle.linear() =
      (Eigen::AngleAxisd(place.tilt_rad, axis) * Eigen::AngleAxisd(place.roll_rad, Vec3::UnitZ()))
          .toRotationMatrix();
  return T_cam_middle * Eigen::Translation3d(-target.middle_target());
}

image::GreyImage draw_rings(const RingScene& scene, const std::vector<SE3>& T_cam_targets,
                            const PictureOptions& options, std::mt19937_64& random) {
  const int width = scene.size.width_px, height = scene.size.height_px;
  std::vector<Mat3> H_target_ideal;
  for (const SE3& T : T_cam_targets) {
    Mat3 H;
    H << T.linear().col(0), T.linear().col(1), T.translation();
    H_target_ideal.push_back(H.inverse());
  }
  std::vector<double> levels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      // Within one pixel the ray moves linearly: 1e-6 px of the distortion's curvature is left out.
      const Vec2 place_px = options.sampled_at ? options.sampled_at(Vec2(u, v)) : Vec2(u, v);
      const Vec3 ray = scene.camera.ray(place_px);
      const Vec2 half_u(0.5, 0), half_v(0, 0.5);
      const Vec3 du = scene.camera.ray(place_px + half_u) - scene.camera.ray(place_px - half_u);
      const Vec3 dv = scene.camera.ray(place_px + half_v) - scene.camera.ray(place_px - half_v);
      double sum = 0;
      for (int i = 0; i < options.samples * options.samples; ++i) {
        const auto [su, sv] = sample_of(scene.target.chessboard(), i, options.samples);
        double level = -1;
        for (std::size_t k = 0; k < H_target_ideal.size() && level < 0; ++k) {
          const Vec3 place = H_target_ideal[k] * (ray + su * du + sv * dv);
          if (place.z() > 0) level = target_level(scene, place.head<2>() / place.z(), options);
        }
        sum += level < 0 ? k_background_grey : level;
      }
      const double light =
          options.light ? options.light(static_cast<double>(u) / width, static_cast<double>(v) / height)
                        : 1.0;
      levels[static_cast<std::size_t>(v * width + u)] = light * sum / (options.samples * options.samples);
    }
  }
  blur(levels, width, height, options.blur_px);
  std::normal_distribution<double> noise(0, 1);
  image::GreyImage picture{.width_px = width, .height_px = height, .pixels = {}};
  for (const double level : levels) {
    const double grey = level + options.noise_grey * noise(random);
    picture.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L)));
  }
  return picture;
}

calibration::PlaneView exact_view(const RingScene& scene, const SE3& T_cam_target, const std::string& name,
                                  double noise_px, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0, 1);
  calibration::GridView grid;
  for (int row = 0; row < scene.target.rows; ++row) {
    for (int col = 0; col < scene.target.cols; ++col) {
      calibration::GridRing ring{.ring = {}, .row = row, .col = col};
      ring.ring.centre_px = scene.camera.project(T_cam_target * scene.target.ring_target(row, col)) +
                            noise_px * Vec2(noise(random), noise(random));
      grid.rings.push_back(ring);
    }
  }
  const SE3 half_turn = SE3(Eigen::Translation3d(2 * scene.target.middle_target())) *
                        Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitZ());
  grid.readings = {calibration::Reading{}, calibration::Reading{.T_this_other = half_turn}};
  return calibration::make_plane_view(name, grid, scene.target);
}

std::vector<ViewPlace> varied_places(int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<ViewPlace> places;
  for (int i = 0; i < count; ++i) {
    places.push_back({.distance_mm = 250 + 40 * unit(random),
                      .shift_mm = Vec2(12 * unit(random), 10 * unit(random)),
                      .roll_rad = 0.3 * unit(random),
                      .tilt_rad = 0.4 + 0.2 * unit(random),
                      .tilt_axis_rad = 2 * std::numbers::pi * i / count});
  }
  return places;
}

}  // namespace biteline::test
