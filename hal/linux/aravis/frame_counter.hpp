// SPDX-License-Identifier: MIT
#pragma once
/// \file The 16-bit block number of a GigE Vision stream as a count that never turns over.

#include <cstdint>

namespace biteline::hal {

/// GigE Vision 1.x: blocks are numbered 1 to 65535, then 1 again; 0 does not occur.  Cameras with 64-bit
/// numbers never reach the turn, and pass through unchanged.  Pure; thread: one owner.
class FrameCounter {
 public:
  /// Number of the very first frame; 1 when it was the first of its acquisition.  Pre: count() was called.
  [[nodiscard]] std::uint64_t first_block() const { return first_block_; }

  /// The last count() was the first.
  [[nodiscard]] bool fresh() const { return fresh_; }

  /// Frames from the first one on, gaps included: 0 for the first.
  [[nodiscard]] std::uint64_t count(std::uint64_t block) {
    fresh_ = !started_;
    if (!started_) {
      started_ = true;
      first_block_ = block;
    } else if (block > last_block_) {
      count_ += block - last_block_;
    } else if (block < last_block_ && last_block_ <= k_last_block) {
      count_ += block + k_last_block - last_block_;
    }
    last_block_ = block;
    return count_;
  }

 private:
  static constexpr std::uint64_t k_last_block = 65535;
  bool started_{false};
  bool fresh_{false};
  std::uint64_t first_block_{0};
  std::uint64_t last_block_{0};
  std::uint64_t count_{0};
};

}  // namespace biteline::hal
