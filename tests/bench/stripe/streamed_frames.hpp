// SPDX-License-Identifier: MIT
#pragma once
/// \file Frames to stream from memory: a set much larger than the caches, each with its own stripe and noise.

#include <cstdint>
#include <span>
#include <vector>

namespace biteline::bench {

class StreamedFrames {
 public:
  struct Size {
    int width_px{0};
    int height_px{0};
  };

  /// About 256 MB of frames.
  explicit StreamedFrames(Size size);

  [[nodiscard]] Size size() const { return size_; }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t frame_bytes() const {
    return static_cast<std::size_t>(size_.width_px) * static_cast<std::size_t>(size_.height_px);
  }
  [[nodiscard]] const std::uint8_t* frame(std::size_t index) const {
    return pixels_.data() + (index % count_) * frame_bytes();
  }
  [[nodiscard]] std::span<const std::uint8_t> all() const { return {pixels_.data(), count_ * frame_bytes()}; }

 private:
  Size size_;
  std::size_t count_;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace biteline::bench
