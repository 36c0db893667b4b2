// SPDX-License-Identifier: MIT
#include "host/bite_line/place/confidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace biteline::bite_line {

double held_of(double claimed, const ConfidenceModel& model) {
  const auto& from = model.claimed;
  const double at = std::clamp(claimed, from.front(), from.back());
  const auto above = std::upper_bound(from.begin() + 1, from.end() - 1, at);
  const auto i = static_cast<std::size_t>(above - from.begin());
  return std::lerp(model.held.at(i - 1), model.held.at(i),
                   (at - from.at(i - 1)) / (from.at(i) - from.at(i - 1)));
}

double line_held_of(double of_line, const ConfidenceModel& model) {
  return 1 - model.line_doubt_ratio * (1 - of_line);
}

}  // namespace biteline::bite_line
