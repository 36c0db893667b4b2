// SPDX-License-Identifier: MIT
#pragma once
/// \file Made pictures of ring targets and chessboards with known camera and poses, for the calibration's
/// tests and benchmarks.

#include <functional>
#include <random>

#include "common/image/grey_image.hpp"
#include "host/calibration/camera/plane_view.hpp"
#include "host/calibration/camera/zhang.hpp"

namespace biteline::test {

struct RingScene {
  geometry::Camera camera{.fu_px = 1400,
                          .fv_px = 1390,
                          .cu_px = 405,
                          .cv_px = 292,
                          .k1 = -0.11,
                          .k2 = 0.14,
                          .p1 = 3e-4,
                          .p2 = -2e-4};
  calibration::PictureSize size{.width_px = 800, .height_px = 600};
  calibration::RingTarget target{
      .rows = 4, .cols = 7, .pitch_mm = 14, .outer_diameter_mm = 12, .inner_diameter_mm = 6};
};

struct PictureOptions {
  double noise_grey{2};
  double blur_px{0.7};
  int samples{4};  ///< per pixel and direction
  /// Seen at another place than where it is shown: as a scaler that takes the nearest pixel, say.
  std::function<Vec2(const Vec2&)> sampled_at{};
  std::function<double(double, double)> light;  ///< factor at (u / width, v / height); 1 when empty
  std::function<bool(const Vec2&)> covered;     ///< target places (mm) hidden by something dark
};

/// Target in cam: its middle at `distance_mm` on the axis, moved by `shift_mm` across it, turned by
/// `roll_rad` about its normal and then tilted by `tilt_rad` about `tilt_axis_rad` in the picture.
struct ViewPlace {
  double distance_mm{260};
  Vec2 shift_mm{Vec2::Zero()};
  double roll_rad{0};
  double tilt_rad{0};
  double tilt_axis_rad{0};
};
[[nodiscard]] SE3 T_cam_target_of(const calibration::RingTarget& target, const ViewPlace& place);

/// A picture of one or more grids (one pose each), ray by ray.
[[nodiscard]] image::GreyImage draw_rings(const RingScene& scene, const std::vector<SE3>& T_cam_targets,
                                          const PictureOptions& options, std::mt19937_64& random);

/// As find_grids() would give it, but with exact centres plus noise and no edges.
[[nodiscard]] calibration::PlaneView exact_view(const RingScene& scene, const SE3& T_cam_target,
                                                const std::string& name, double noise_px,
                                                std::mt19937_64& random);

/// `count` places that determine a camera: tilts of 10 to 35 degrees about all axes.
[[nodiscard]] std::vector<ViewPlace> varied_places(int count, std::mt19937_64& random);

}  // namespace biteline::test
