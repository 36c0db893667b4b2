// SPDX-License-Identifier: MIT
#pragma once
/// \file Intrinsics and lens distortion from several pictures of a ring grid.

#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/calibration/camera/bundle.hpp"
#include "host/calibration/camera/zhang.hpp"

namespace biteline::calibration {

/// What a whole folder of pictures may have in common, whatever they show.
enum class PictureFault {
  None,    ///< it is this picture's own
  Size,    ///< another size than the folder's others
  Mosaic,  ///< raw, of a colour sensor
};

/// A picture, pose or ring set aside, and why: reported, never silent.
struct SetAside {
  std::string name;
  std::string reason;
  PictureFault fault{PictureFault::None};
};

struct CameraView {
  PlaneView view;  ///< with its centres as finally used
  SE3 T_cam_target{SE3::Identity()};
  double rms_px{0};
  int rings_set_aside{0};
};

struct CameraCalibration {
  geometry::Camera camera;
  PictureSize size;
  CameraMatrix covariance{CameraMatrix::Zero()};  ///< of fu fv cu cv k1 k2 p1 p2 k3
  DistortionChoice distortion{};                  ///< which coefficients the data support; the others are 0
  double rms_px{0};
  double sigma_px{0};          ///< noise of one coordinate of one centre
  double coverage_ratio{0};    ///< share of 8 x 6 fields of the picture that hold a centre
  double largest_tilt_rad{0};  ///< of a target's normal against the optical axis
  std::vector<CameraView> views;
  std::vector<SetAside> set_aside;
  int iterations{0};

  [[nodiscard]] CameraVector sigma() const { return covariance.diagonal().cwiseSqrt(); }
};

/// Zhang's closed form, then everything refined together; views that contradict the others are set aside and
/// named; coefficients that the data cannot tell from 0 are left out.  Refuses with the reason: fewer than 3
/// good views, focal length not determined, residuals too large, views that do not agree.
[[nodiscard]] Result<CameraCalibration> calibrate_camera(std::vector<PlaneView> views, PictureSize size);

}  // namespace biteline::calibration
