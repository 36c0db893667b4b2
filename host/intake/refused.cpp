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
      report::RefusalRow<Refused>{
          Refused::ScanSetAside, "scan_set_aside",
          "scan the shoe again, and keep this folder: its recording shows the defect"},
      report::RefusalRow<Refused>{Refused::ScanStopped, "stopped_by_a_person",
                                  "start, then scan the shoe again"},
  };
  return k_rows;
}

}  // namespace biteline::intake
