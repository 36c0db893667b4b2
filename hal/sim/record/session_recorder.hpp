// SPDX-License-Identifier: MIT
#pragma once
/// \file A whole scan as a recorded session, without running time: pictures, poses, truth.

#include <functional>
#include <optional>

#include "hal/sim/record/arrival_stamps.hpp"
#include "hal/sim/record/disturbances.hpp"
#include "hal/sim/record/made_scene.hpp"

namespace biteline::sim {

/// The flange's way through a scan, from its begin at time 0; truth and report need not agree.
struct HeadWay {
  double duration_s{0};
  std::function<SE3(double time_s)> T_base_flange_at{};
  std::function<SE3(double time_s)> T_base_flange_told_at{};
};

struct RecordSettings {
  double pose_noise_mm{0.010};    ///< standard deviation of each stamped position
  double pose_noise_rad{5.2e-5};  ///< 0.003 degrees, of each stamped orientation
  double pose_rate_hz{500};
  Nanoseconds pose_clock_offset{0};  ///< robot clock minus camera clock
  bool tell_clock_offset{true};      ///< false: sensor.yaml says 0 whatever it is, as before its calibration
  Nanoseconds start{1'700'000'000'000'000'000};  ///< camera clock at the first frame
  std::uint64_t noise_seed{1};
  std::optional<OutlinePart> part{};  ///< only the frames with their stripe there; none: the whole scan
  /// None: as if no arm carried the head, at an even speed.  Pre: no `part` beside it.
  std::optional<HeadWay> way{};
  Disturbances disturbances{};  ///< the arm's own are in `way`
  /// None: stamps are the middles of the exposures, as with a trigger.
  std::optional<ArrivalStamps> arrival{};
};

/// Writes SESSION/ in the exchange format (README, "Data formats"), truth included.  Same arguments, same
/// files. `progress` is called with the share done, may be empty.
[[nodiscard]] Result<void> record_session(const std::filesystem::path& folder, const MadeScene& scene,
                                          const RecordSettings& settings,
                                          const std::function<void(double)>& progress);

}  // namespace biteline::sim
