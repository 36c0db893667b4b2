// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/random.hpp"

#include <bit>
#include <cmath>

namespace biteline::sim {

namespace {

std::uint64_t split_mix(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9E3779B97F4A7C15ULL);
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

}  // namespace

Random::Random(std::uint64_t seed) : seed_(seed) {
  std::uint64_t mixer = seed;
  for (auto& word : state_) word = split_mix(mixer);
}

Random Random::fork(std::uint64_t purpose) const {
  std::uint64_t mixer = seed_ ^ (purpose * 0xD1342543DE82EF95ULL);
  return Random{split_mix(mixer)};
}

std::uint64_t Random::next() {
  const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
  const std::uint64_t shifted = state_[1] << 17U;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::uniform(Interval interval) {
  const double unit = static_cast<double>(next() >> 11U) * 0x1.0p-53;
  return interval.low + (interval.high - interval.low) * unit;
}

int Random::integer(int low, int high) {
  return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1));
}

double Random::gaussian() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  for (;;) {
    const double u = uniform({-1, 1});
    const double v = uniform({-1, 1});
    const double square = u * u + v * v;
    if (square >= 1 || square < 1e-300) continue;
    const double scale = std::sqrt(-2 * std::log(square) / square);
    spare_ = v * scale;
    has_spare_ = true;
    return u * scale;
  }
}

}  // namespace biteline::sim
