// SPDX-License-Identifier: MIT
#pragma once
/// \file Hand-over between two threads: one pushes, one pops, nobody waits.

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "common/rt/annotations.hpp"

namespace biteline::rt {

/// x86-64 and Cortex-A lines; keeps the two sides' counters from sharing one.
inline constexpr std::size_t k_cache_line_bytes = 64;

/// Ring that drops the oldest when full and gives the victim back to the producer: for handles of pooled
/// buffers, whose victim goes back to the pool and is counted.
///
/// The producer takes the oldest by the same compare-and-swap on tail_ as the consumer (iceoryx, spsc_sofi).
/// The bad interleaving: the consumer has read tail_ = r and copies slot r while the producer steals r and
/// writes item r + Capacity into the same slot.  The steal has moved tail_ to r + 1 before that write, so the
/// consumer's own compare-and-swap on r fails and its copy is thrown away; tail_ only grows, so it cannot be
/// r again.  The copy itself is no data race because slots are atomic; hence T must fit a lock-free atomic.
///
/// Thread: one producer, one consumer.  RT: all members; rt_pop repeats only when the producer stole
/// meanwhile.
template <class T, std::size_t Capacity>
class DropOldestRing {
  static_assert(std::has_single_bit(Capacity), "indices wrap by mask");
  static_assert(std::atomic<T>::is_always_lock_free, "pass handles, not payloads");

 public:
  /// Always takes `item`; returns the oldest when it had to go.
  [[nodiscard]] std::optional<T> rt_push(T item) noexcept BITELINE_RT {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    std::uint64_t tail = tail_.load(std::memory_order_acquire);
    std::optional<T> victim;
    if (head - tail == Capacity) {
      const T oldest = slots_[tail & k_mask].load(std::memory_order_relaxed);
      // Failure: the consumer took it just now, so there is room.
      if (tail_.compare_exchange_strong(tail, tail + 1, std::memory_order_acq_rel,
                                        std::memory_order_acquire)) {
        victim = oldest;
      }
    }
    slots_[head & k_mask].store(item, std::memory_order_relaxed);
    head_.store(head + 1, std::memory_order_release);
    return victim;
  }

  [[nodiscard]] std::optional<T> rt_pop() noexcept BITELINE_RT {
    std::uint64_t tail = tail_.load(std::memory_order_acquire);
    while (tail != head_.load(std::memory_order_acquire)) {
      const T item = slots_[tail & k_mask].load(std::memory_order_relaxed);
      if (tail_.compare_exchange_strong(tail, tail + 1, std::memory_order_acq_rel,
                                        std::memory_order_acquire)) {
        return item;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] static constexpr std::size_t capacity() { return Capacity; }

 private:
  static constexpr std::uint64_t k_mask = Capacity - 1;
  alignas(k_cache_line_bytes) std::atomic<std::uint64_t> head_{0};
  alignas(k_cache_line_bytes) std::atomic<std::uint64_t> tail_{0};
  alignas(k_cache_line_bytes) std::array<std::atomic<T>, Capacity> slots_{};
};

}  // namespace biteline::rt
