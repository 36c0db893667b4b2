// SPDX-License-Identifier: MIT
#pragma once
/// \file When a way that is counted in ticks has gone on by another pitch.

#include <cstdint>
#include <cstdlib>
#include <optional>

namespace biteline::hal {

/// A pitch is a distance from where the last one was reached, so that an axis that trembles about a border
/// makes no pulse after the first, and one that goes back makes them on the way back too. Pure; thread: one
/// owner.
class PitchGrid {
 public:
  /// Pre: pitch_ticks > 0.
  explicit PitchGrid(std::int64_t pitch_ticks) : pitch_ticks_{pitch_ticks} {}

  /// How many pitches were reached since the call before; 0 at the first.
  std::int64_t on_position(std::int64_t position_ticks) {
    if (!reached_ticks_) reached_ticks_ = position_ticks;
    const std::int64_t pitches = (position_ticks - *reached_ticks_) / pitch_ticks_;
    *reached_ticks_ += pitches * pitch_ticks_;
    return std::abs(pitches);
  }

 private:
  std::int64_t pitch_ticks_;
  std::optional<std::int64_t> reached_ticks_;
};

}  // namespace biteline::hal
