// SPDX-License-Identifier: MIT
#pragma once
/// \file The laser plane in the camera frame, from pictures of a stripe on planes of known pose.

#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "host/calibration/camera/camera_calibration.hpp"
#include "host/calibration/laser/stripe.hpp"

namespace biteline::calibration {

/// One place of the laser target: its grids with the lamp on, its stripe with the laser on.
struct LaserPictures {
  std::string name;
  std::vector<PlaneView> planes;             ///< one or two grids
  std::vector<StripePoint> stripe;           ///< thinned
  bool along_columns{false};                 ///< so the stripe runs, and hardly a column meets it once
  std::optional<double> speckle_contrast{};  ///< of the stripe's light, where it shows it
};

/// A stripe point on the target's plane `plane` of its view.
struct PlaneStripePoint {
  StripePoint seen;
  int plane{0};
};

struct LaserView {
  LaserPictures pictures;
  std::vector<SE3> T_cam_plane;          ///< of each grid
  std::vector<PlaneStripePoint> points;  ///< used
  bool rigid{false};  ///< both grids seen, numbered and ordered so that their relation is the common one
  double rms_mm{0};   ///< of its points' distances from the laser plane
};

struct LaserCalibration {
  geometry::LaserPlane plane;
  double rms_mm{0};
  int points{0};
  int points_set_aside{0};
  SE3 T_plane1_plane2{SE3::Identity()};  ///< of the two-plane target, where both were seen
  bool two_planes{false};
  Vec3 middle_cam{Vec3::Zero()};             ///< of the stripe points: the middle of the working region
  std::optional<double> speckle_contrast{};  ///< of the light: the median of those views that show it
  std::vector<LaserView> views;
  std::vector<SetAside> set_aside;
};

/// Stripe points are put onto their plane's rings and half a pitch beyond, and a plane is fitted robustly to
/// all of them by total least squares.  Views that lie off the others' plane are set aside and named. Refuses
/// with the reason: fewer than 3 good views, all points on one line, residuals too large. The normal points
/// to the camera's side, d < 0.
[[nodiscard]] Result<LaserCalibration> calibrate_laser(const geometry::Camera& camera,
                                                       std::vector<LaserPictures> pictures);

/// Plane of least squared distances; the points' standard deviations along its axes, largest first.
struct LaserPlaneFit {
  geometry::LaserPlane plane;
  Vec3 spread_mm{Vec3::Zero()};
  Vec3 middle{Vec3::Zero()};
};
[[nodiscard]] LaserPlaneFit fit_plane(const std::vector<Vec3>& points);

}  // namespace biteline::calibration
