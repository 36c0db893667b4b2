// SPDX-License-Identifier: MIT
#include "firmware/record/picture_pace.hpp"

#include <chrono>

namespace biteline::record {
namespace {

/// A fifth of the room for pictures at 1626 x 1236 and 100 Hz.
constexpr Nanoseconds k_in_time = std::chrono::milliseconds{60};
constexpr std::uint32_t k_look_again = 64;
constexpr double k_weight = 1.0 / 8;

}  // namespace

bool PicturePace::packed(Nanoseconds late) {
  if (late <= k_in_time) return true;
  const Mean &stored = means_[0], &packed = means_[1];
  if (!stored.known || !packed.known) return !packed.known;
  const bool slower = packed.ns >= stored.ns;
  return ++hurried_ % k_look_again == 0 ? slower : !slower;
}

void PicturePace::note(bool packed, Nanoseconds took) {
  Mean& mean = means_[packed ? 1 : 0];
  const auto ns = static_cast<double>(took.count());
  mean.ns = mean.known ? mean.ns + k_weight * (ns - mean.ns) : ns;
  mean.known = true;
}

}  // namespace biteline::record
