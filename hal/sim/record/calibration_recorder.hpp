// SPDX-License-Identifier: MIT
#pragma once
/// \file A calibration folder of a made head, with the true answer.

#include <filesystem>
#include <optional>

#include "hal/sim/record/session_recorder.hpp"

namespace biteline::sim {

struct CalibrationSettings {
  std::uint64_t head_seed{21};
  std::uint64_t view_seed{1};  ///< other views and other noise of the same head
  int camera_views{12};
  int laser_views{6};
  int handeye_views{13};
  double pose_noise_mm{0.020};
  double pose_noise_rad{1e-4};
  double plane_angle_error_rad{
      0.03};                  ///< how far the two-plane target is from 90 degrees, standard deviation
  int averaged{1};            ///< each picture is the mean of so many exposures
  int chessboard_squares{0};  ///< from one ring's centre to the next, boards in their place; 0: rings
  HeadLight light{};          ///< of the laser pictures, and of clock/
  double scaled_ratio{1};     ///< lit pictures are filled from ones of this size, nearest pixel
  /// With it a clock/ session is added: robot clock minus camera clock, not told in its sensor.yaml.
  std::optional<Nanoseconds> clock_offset;
};

/// CALIB/ in the exchange format (README, "Data formats").  Same arguments, same files.
[[nodiscard]] Result<void> record_calibration(const std::filesystem::path& folder,
                                              const CalibrationSettings& settings,
                                              const std::function<void(double)>& progress);

}  // namespace biteline::sim
