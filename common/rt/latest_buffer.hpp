// SPDX-License-Identifier: MIT
#pragma once
/// \file The newest of something large, handed over without a copy.

#include <array>
#include <atomic>
#include <cstdint>

#include "common/rt/annotations.hpp"

namespace biteline::rt {

/// Three buffers: one is the writer's, one the reader's, and the third lies between them.  Neither ever
/// waits; what the reader does not take before the next comes is overwritten.
///
/// Thread: one writer (rt_back, rt_publish), one reader (rt_take).  RT: all members.  Memory: inside the
/// object.
template <class T>
class LatestBuffer {
 public:
  LatestBuffer() = default;
  explicit LatestBuffer(const T& initial) : buffers_{initial, initial, initial} {}

  /// The writer's buffer; holds whatever was in it.
  [[nodiscard]] T& rt_back() noexcept BITELINE_RT { return buffers_[back_]; }

  /// What is in rt_back() becomes the newest.
  void rt_publish() noexcept BITELINE_RT {
    // release: the content goes before its index; acquire: the reader is done with the buffer that comes
    // back.
    back_ = middle_.exchange(back_ | k_fresh, std::memory_order_acq_rel) & k_index;
  }

  /// Null: nothing new since the last one.  Valid until the next call.
  [[nodiscard]] const T* rt_take() noexcept BITELINE_RT {
    if ((middle_.load(std::memory_order_relaxed) & k_fresh) == 0) return nullptr;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & k_index;
    return &buffers_[front_];
  }

 private:
  static constexpr std::uint32_t k_index = 3;
  static constexpr std::uint32_t k_fresh = 4;
  std::array<T, 3> buffers_{};
  std::uint32_t back_{0};  ///< the writer's own
  std::atomic<std::uint32_t> middle_{1};
  std::uint32_t front_{2};  ///< the reader's own
};

}  // namespace biteline::rt
