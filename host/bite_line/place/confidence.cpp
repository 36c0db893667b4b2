// SPDX-License-Identifier: MIT
#include "host/bite_line/place/confidence.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::bite_line {

double bridge_held_of(const BridgeSpread& bridge, const ConfidenceModel& model) {
  const double spread_mm = model.least_mm + model.corner_ratio * bridge.corner_mm + bridge.tried_mm;
  const auto above =
      std::upper_bound(model.shares.begin(), model.shares.end(), spread_mm,
                       [](double value, const SpreadShare& share) { return value < share.spread_mm; });
  if (above == model.shares.begin()) return above->held;
  const SpreadShare& low = *(above - 1);
  const double times = spread_mm / low.spread_mm;
  if (above == model.shares.end()) return low.held / (times * times);
  return low.held + std::log(times) / std::log(above->spread_mm / low.spread_mm) * (above->held - low.held);
}

double jump_held_of(double jump_mm, const ConfidenceModel& model) {
  const double jump = jump_mm / model.jump_mm;
  return 1 / (1 + jump * jump);
}

double flat_held_of(double sharp, const ConfidenceModel& model) {
  return std::max(sharp, model.flat_held);
}

double line_held_of(double of_line, const ConfidenceModel& model) {
  return 1 - model.line_doubt_ratio * (1 - of_line);
}

}  // namespace biteline::bite_line
