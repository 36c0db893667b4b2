// SPDX-License-Identifier: MIT
#pragma once
/// \file A whole scan as a recorded session, without running time: pictures, poses, truth.

#include <functional>
#include <optional>

#include "hal/sim/record/made_scene.hpp"

namespace biteline::sim {

struct RecordSettings {
  double pose_noise_mm{0.010};    ///< standard deviation of each stamped position
  double pose_noise_rad{5.2e-5};  ///< 0.003 degrees, of each stamped orientation
  double pose_rate_hz{500};
  Nanoseconds pose_clock_offset{0};  ///< robot clock minus camera clock
  bool tell_clock_offset{true};      ///< false: sensor.yaml says 0 whatever it is, as before its calibration
  Nanoseconds start{1'700'000'000'000'000'000};  ///< camera clock at the first frame
  std::uint64_t noise_seed{1};
  std::optional<OutlinePart> part{};  ///< only the frames with their stripe there; none: the whole scan
};

/// Writes SESSION/ in the exchange format (README, "Data formats"), truth included.  Same arguments, same
/// files. `progress` is called with the share done, may be empty.
[[nodiscard]] Result<void> record_session(const std::filesystem::path& folder, const MadeScene& scene,
                                          const RecordSettings& settings,
                                          const std::function<void(double)>& progress);

}  // namespace biteline::sim
