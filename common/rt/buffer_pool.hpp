// SPDX-License-Identifier: MIT
#pragma once
/// \file A fixed set of large buffers (frames, profiles), passed between threads by number.

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "common/core/contracts.hpp"
#include "common/rt/annotations.hpp"

namespace biteline::rt {

/// Number of a buffer in its pool: what rings carry.
using BufferIndex = std::uint32_t;

/// At most `MaxCount` buffers, all made and touched in the constructor.
///
/// Thread: rt_acquire and rt_release from any thread; a buffer's content belongs to whoever acquired it or
/// received its number through a ring.  RT: rt_ members.  Memory: one array on the heap, at start-up.
template <class T, std::size_t MaxCount = 64>
class BufferPool {
  static_assert(MaxCount <= 64, "the free set is one word");

 public:
  explicit BufferPool(std::size_t count) : count_{count}, buffers_{std::make_unique<T[]>(count)} {
    BITELINE_EXPECTS(count >= 1 && count <= MaxCount);
    free_.store(count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1, std::memory_order_release);
  }

  /// Nothing: all are in use.  The caller counts that as an overrun.
  [[nodiscard]] std::optional<BufferIndex> rt_acquire() noexcept BITELINE_RT {
    std::uint64_t free = free_.load(std::memory_order_relaxed);
    while (free != 0) {
      const std::uint64_t lowest = free & (~free + 1);
      // acquire: pairs with the release of the buffer's last user.
      if (free_.compare_exchange_weak(free, free & ~lowest, std::memory_order_acquire,
                                      std::memory_order_relaxed)) {
        return static_cast<BufferIndex>(std::countr_zero(lowest));
      }
    }
    return std::nullopt;
  }

  /// Pre: `index` is acquired.
  void rt_release(BufferIndex index) noexcept BITELINE_RT {
    BITELINE_EXPECTS(index < count_);
    const std::uint64_t bit = std::uint64_t{1} << index;
    const std::uint64_t before = free_.fetch_or(bit, std::memory_order_release);
    BITELINE_EXPECTS((before & bit) == 0);
  }

  [[nodiscard]] T& operator[](BufferIndex index) noexcept { return buffers_[index]; }
  [[nodiscard]] const T& operator[](BufferIndex index) const noexcept { return buffers_[index]; }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t rt_free_count() const noexcept BITELINE_RT {
    return static_cast<std::size_t>(std::popcount(free_.load(std::memory_order_relaxed)));
  }

 private:
  std::size_t count_;
  std::unique_ptr<T[]> buffers_;
  std::atomic<std::uint64_t> free_{0};
};

}  // namespace biteline::rt
