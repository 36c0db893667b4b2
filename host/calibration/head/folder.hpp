// SPDX-License-Identifier: MIT
#pragma once
/// \file A calibration folder (README, "Data formats"), read into views.

#include <filesystem>
#include <optional>
#include <vector>

#include "common/core/result.hpp"
#include "host/calibration/handeye/hand_eye.hpp"
#include "host/calibration/laser/laser_calibration.hpp"

namespace biteline::calibration {

/// What a picture gave: rings drawn into it for the report need the picture's name only.
struct CameraFolder {
  RingTarget target;
  PictureSize size;
  std::vector<PlaneView> views;
  std::vector<SetAside> set_aside;  ///< pictures without a grid, of another size
};

struct LaserFolder {
  RingTarget target;
  PictureSize size;
  std::vector<LaserPictures> places;
  std::vector<SetAside> set_aside;  ///< of another size, or raw mosaics
};

struct ArmPicture {
  PlaneView view;
  SE3 T_base_flange{SE3::Identity()};
};

struct HandEyeFolder {
  RingTarget target;
  PictureSize size;
  std::vector<ArmPicture> views;
  std::vector<SetAside> set_aside;
};

/// Pictures are searched in parallel.  Faults of files are errors; a picture in which nothing is found, or of
/// another size than most, is set aside by name.
[[nodiscard]] Result<CameraFolder> read_camera_folder(const std::filesystem::path& calib);
[[nodiscard]] Result<LaserFolder> read_laser_folder(const std::filesystem::path& calib);
[[nodiscard]] Result<HandEyeFolder> read_hand_eye_folder(const std::filesystem::path& calib);

}  // namespace biteline::calibration
