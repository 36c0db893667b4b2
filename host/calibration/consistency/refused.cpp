// SPDX-License-Identifier: MIT
#include "host/calibration/consistency/refused.hpp"

#include <array>

namespace biteline::consistency {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  static constexpr std::array k_rows{
      report::RefusalRow<Refused>{
          Refused::NotAsCalibrated, "not_as_calibrated",
          "look at the camera's mirror, turn, binning and region, and whether the head "
          "was knocked; set it as it was, or calibrate anew"},
  };
  return k_rows;
}

}  // namespace biteline::consistency
