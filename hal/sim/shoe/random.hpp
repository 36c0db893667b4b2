// SPDX-License-Identifier: MIT
#pragma once
/// \file Random numbers that are the same on every machine and library for one seed.

#include <cstdint>

namespace biteline::sim {

/// xoshiro256** (Blackman, Vigna 2018), seeded by SplitMix64.  The standard library's distributions differ
/// between implementations; a made scene must not.  Not thread-safe.
class Random {
 public:
  struct Interval {
    double low;
    double high;
  };

  explicit Random(std::uint64_t seed);

  /// An independent stream for one purpose, so that a new feature does not shift the numbers of the others.
  [[nodiscard]] Random fork(std::uint64_t purpose) const;

  std::uint64_t next();
  double uniform(Interval interval);
  /// Whole numbers low..high, both included.
  int integer(int low, int high);
  bool chance(double probability) { return uniform({0, 1}) < probability; }
  /// Standard normal deviate (Marsaglia's polar method).
  double gaussian();

 private:
  std::uint64_t state_[4]{};
  std::uint64_t seed_;
  double spare_{0};
  bool has_spare_{false};
};

}  // namespace biteline::sim
