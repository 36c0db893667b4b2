// SPDX-License-Identifier: MIT
#include "host/bite_line/place/confidence.hpp"

#include <cmath>

namespace biteline::bite_line {

double bridge_held_of(const BridgeSpread& bridge, const ConfidenceModel& model) {
  const double spread_mm = model.least_mm + std::hypot(model.corner_ratio * bridge.corner_mm, bridge.tried_mm,
                                                       model.doubt_mm * bridge.doubt);
  return 1 / (1 + std::pow(spread_mm / model.half_mm, model.power));
}

double jump_held_of(double jump_mm, const ConfidenceModel& model) {
  const double jump = jump_mm / model.jump_mm;
  return 1 / (1 + jump * jump);
}

double line_held_of(double of_line, const ConfidenceModel& model) {
  return 1 - model.line_doubt_ratio * (1 - of_line);
}

}  // namespace biteline::bite_line
