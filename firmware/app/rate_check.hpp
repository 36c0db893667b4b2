// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether this program keeps up with the head's own rate, on this machine, in the dark.

#include "firmware/app/scanner.hpp"
#include "firmware/app/source.hpp"

namespace biteline::sensor {

struct RateCheck {
  double wanted_hz{0};      ///< profiles, as the head's settings say; 0: they name no rate
  double profiles_hz{0};    ///< made a second
  double slack_hz{0};       ///< one frame more or less in the time that was measured
  double late_ratio{0};     ///< share of the frames beyond the budget of one (5 ms); 0 at 80 Hz and below
  double lost_ratio{0};     ///< share of them that was lost on the way, or damaged
  double no_pose_ratio{0};  ///< of the profiles: share without a pose near enough to their exposure

  /// At least 95 of 100 frames, at most 5 of 100 late, at most 1 of 100 lost.
  [[nodiscard]] bool kept() const;
  /// Each profile waits for its pose, so that a rate without poses is no rate.
  [[nodiscard]] bool poses_lacked() const;
};

/// Runs camera, peaks and triangulation as a scan does, for `duration` from the first profile on; nothing is
/// kept or sent.  Pre: the laser is held dark by somebody.  Errc::Timeout: no frame came.
[[nodiscard]] Result<RateCheck> check_rate(SourceKind& kind, const Scanner::Config& config,
                                           const hal::Clock& clock, Nanoseconds duration);

}  // namespace biteline::sensor
