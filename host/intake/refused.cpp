// SPDX-License-Identifier: MIT
#include "host/intake/refused.hpp"

#include <array>

namespace biteline::intake {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  static constexpr std::array k_rows{
      report::RefusalRow<Refused>{Refused::ScanNotComplete, "scan_not_complete", "scan the shoe again"},
      report::RefusalRow<Refused>{Refused::TestPattern, "test_pattern",
                                  "turn camera.test_pattern off, then scan the shoe"},
      report::RefusalRow<Refused>{Refused::CameraState, "camera_state",
                                  "set the camera as the reason says and switch off what sets it otherwise, "
                                  "or calibrate it as it is"},
      report::RefusalRow<Refused>{Refused::StoppedByAPerson, "stopped_by_a_person",
                                  "start, when the cell is clear"},
      report::RefusalRow<Refused>{
          Refused::ScanSetAside, "scan_set_aside",
          "scan the shoe again, and keep this folder: its recording shows the defect"},
      report::RefusalRow<Refused>{
          Refused::NoPoses, "no_poses",
          "check the arm's cable, that its controller is on, and that board.yaml names its address"},
      report::RefusalRow<Refused>{Refused::PosesTooFar, "poses_too_far",
                                  "check the arm's cable and pose_clock_offset_ns, and that nothing else "
                                  "loads sensor and network; then scan again"},
      report::RefusalRow<Refused>{Refused::ClockUnsure, "clock_unsure",
                                  "wait until the camera's clock is tied (biteline doctor tells), then scan "
                                  "again"},
      report::RefusalRow<Refused>{Refused::TriggerMismatch, "trigger_mismatch",
                                  "check the lines of trigger and strobe, then scan again"},
      report::RefusalRow<Refused>{Refused::FramesDamaged, "frames_damaged",
                                  "check the camera's cable and its network, then scan again"},
      report::RefusalRow<Refused>{Refused::NoTime, "no_time",
                                  "end what else runs on sensor and host, or set a lower rate or fewer rows; "
                                  "then scan again"},
      report::RefusalRow<Refused>{Refused::FramesLost, "frames_lost",
                                  "check the camera's cable and network, or set a lower rate or fewer rows; "
                                  "then scan again"},
      report::RefusalRow<Refused>{Refused::NoStripe, "no_stripe",
                                  "look at the live picture: laser on, stripe inside the region, exposure "
                                  "neither too short nor too long; then scan again"},
      report::RefusalRow<Refused>{Refused::StripeAlongColumns, "stripe_along_columns",
                                  "turn camera or laser by 90 degrees, so that the stripe crosses every "
                                  "column once, then calibrate"},
  };
  return k_rows;
}

}  // namespace biteline::intake
