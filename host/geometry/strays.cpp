// SPDX-License-Identifier: MIT
#include "host/geometry/strays.hpp"

#include <cmath>

#include "host/geometry/closed_curve.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::geometry {

std::vector<std::size_t> spikes_of(std::span<const double> values, std::span<const std::uint8_t> known,
                                   const SpikeLimits& limits) {
  const auto beside = static_cast<std::ptrdiff_t>(limits.beside);
  std::vector<std::size_t> spikes;
  std::vector<double> around;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (known[i] == 0) continue;
    around.clear();
    for (std::ptrdiff_t k = -beside; k <= beside; ++k) {
      const std::size_t other = round_index(i, k, values.size());
      if (known[other] != 0) around.push_back(values[other]);
    }
    if (std::abs(values[i] - median_of(std::span<double>{around})) > limits.most) spikes.push_back(i);
  }
  return spikes;
}

}  // namespace biteline::geometry
