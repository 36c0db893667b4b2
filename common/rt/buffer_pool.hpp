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
  static constexpr std::size_t k_word_bits = 64;
  static constexpr std::size_t k_words = (MaxCount + k_word_bits - 1) / k_word_bits;

 public:
  explicit BufferPool(std::size_t count) : count_{count}, buffers_{std::make_unique<T[]>(count)} {
    BITELINE_EXPECTS(count >= 1 && count <= MaxCount);
    for (std::size_t index = 0; index < count; ++index)
      word_of(index).fetch_or(bit_of(index), std::memory_order_release);
  }

  /// Nothing: all are in use.  The caller counts that as an overrun.  With several acquirers it may also miss
  /// a buffer that came free behind its search.
  [[nodiscard]] std::optional<BufferIndex> rt_acquire() noexcept BITELINE_RT {
    for (std::size_t word = 0; word < k_words; ++word) {
      std::uint64_t free = free_[word].load(std::memory_order_relaxed);
      while (free != 0) {
        const std::uint64_t lowest = free & (~free + 1);
        // acquire: pairs with the release of the buffer's last user.
        if (free_[word].compare_exchange_weak(free, free & ~lowest, std::memory_order_acquire,
                                              std::memory_order_relaxed)) {
          return static_cast<BufferIndex>(word * k_word_bits +
                                          static_cast<std::size_t>(std::countr_zero(lowest)));
        }
      }
    }
    return std::nullopt;
  }

  /// Pre: `index` is acquired.
  void rt_release(BufferIndex index) noexcept BITELINE_RT {
    BITELINE_EXPECTS(index < count_);
    const std::uint64_t before = word_of(index).fetch_or(bit_of(index), std::memory_order_release);
    BITELINE_EXPECTS((before & bit_of(index)) == 0);
  }

  [[nodiscard]] T& operator[](BufferIndex index) noexcept { return buffers_[index]; }
  [[nodiscard]] const T& operator[](BufferIndex index) const noexcept { return buffers_[index]; }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t rt_free_count() const noexcept BITELINE_RT {
    std::size_t count = 0;
    for (const std::atomic<std::uint64_t>& word : free_) {
      count += static_cast<std::size_t>(std::popcount(word.load(std::memory_order_relaxed)));
    }
    return count;
  }

 private:
  [[nodiscard]] std::atomic<std::uint64_t>& word_of(std::size_t index) { return free_[index / k_word_bits]; }
  [[nodiscard]] static std::uint64_t bit_of(std::size_t index) {
    return std::uint64_t{1} << (index % k_word_bits);
  }

  std::size_t count_;
  std::unique_ptr<T[]> buffers_;
  std::array<std::atomic<std::uint64_t>, k_words> free_{};
};

}  // namespace biteline::rt
