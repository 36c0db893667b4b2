// SPDX-License-Identifier: MIT
#include "host/calibration/head/refused.hpp"

#include <array>

namespace biteline::calibration {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  using enum Refused;
  using Row = report::RefusalRow<Refused>;
  static constexpr const char* k_again = "check what the reason names, then calibrate again";
  static constexpr std::array k_rows{
      Row{CameraNotTrusted, "camera_not_trusted", "take more sharp pictures of the target for camera/"},
      Row{CameraNotDetermined, "camera_not_determined", "tilt the target more, in several directions"},
      Row{CameraNotConverged, "camera_not_converged", k_again},
      Row{LaserNotTrusted, "laser_not_trusted", "take more pictures of stripe and target for laser/"},
      Row{LaserNotDetermined, "laser_not_determined", "put the target at more distances from the head"},
      Row{LaserNotConverged, "laser_not_converged", k_again},
      Row{HandEyeNotTrusted, "hand_eye_not_trusted",
          "check poses and units in handeye/, then record it again"},
      Row{HandEyeNotDetermined, "hand_eye_not_determined", "turn the head about more axes between pictures"},
      Row{HandEyeNotConverged, "hand_eye_not_converged", k_again},
      Row{TogetherNotTrusted, "together_not_trusted", "record the folder again that the reason names"},
      Row{TogetherNotDetermined, "together_not_determined", k_again},
      Row{TogetherNotConverged, "together_not_converged", k_again},
      Row{ClockNotTrusted, "clock_not_trusted", "record clock/ again"},
      Row{ClockNotDetermined, "clock_not_determined",
          "scan one place twice, each time with another velocity"},
      Row{ClockNotConverged, "clock_not_converged", "record clock/ again"},
      Row{GradeBad, "calibration_bad",
          "take the pictures again that the report names, with focus, lens and target left alone"},
      Row{MosaicPictures, "mosaic_pictures",
          "set the camera to a grey (mono) format, or convert the pictures to grey, then take them again"},
      Row{PictureSizes, "picture_sizes",
          "take all pictures with the same size, binning and region of the camera"},
      Row{LaserAlongColumns, "laser_along_columns",
          "turn camera or laser by 90 degrees, so that the stripe crosses every column once"},
      Row{PosesFrozen, "poses_frozen",
          "see that the controller sends new poses, then record a pose anew at each picture"},
  };
  return k_rows;
}

Refusal refusal_of(Part part, const Error& error) {
  BITELINE_EXPECTS(error_row(error.code).exit_status == ExitStatus::Refused);
  const int kind = error.code == Errc::Degenerate ? 1 : error.code == Errc::NotConverged ? 2 : 0;
  return {.code = static_cast<Refused>(3 * static_cast<int>(part) + kind),
          .reason = std::string{error.where.view()}};
}

}  // namespace biteline::calibration
