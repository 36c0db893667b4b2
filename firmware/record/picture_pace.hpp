// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether the next picture is packed: what the machine can do, or what the disk can, is the limit.

#include <array>
#include <cstdint>

#include "common/time/clocks.hpp"

namespace biteline::record {

/// Packed while there is time.  In a hurry what took less time of late, looked at again now and then: a disk
/// takes much at first, and less once its cache is full.  Thread: one owner.
class PicturePace {
 public:
  /// `late`: since the picture's exposure.
  [[nodiscard]] bool packed(Nanoseconds late);
  /// What a picture took until it was written.
  void note(bool packed, Nanoseconds took);

 private:
  struct Mean {
    double ns{0};
    bool known{false};
  };
  std::array<Mean, 2> means_;  ///< stored, packed
  std::uint32_t hurried_{0};
};

}  // namespace biteline::record
