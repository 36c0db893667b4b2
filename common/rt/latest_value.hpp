// SPDX-License-Identifier: MIT
#pragma once
/// \file The newest value of something, for whoever looks.

#include <atomic>
#include <cstdint>
#include <optional>

#include "common/rt/annotations.hpp"
#include "common/rt/word_copy.hpp"

namespace biteline::rt {

/// Sequence lock: the writer never waits; a reader repeats while it meets the writer at work.
///
/// Thread: one writer, any number of readers.  RT: all members.
template <class T>
class LatestValue {
 public:
  void rt_store(const T& value) noexcept BITELINE_RT {
    const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    // Odd: being written.  Ordered before the words by their release stores.
    sequence_.store(sequence + 1, std::memory_order_relaxed);
    words_.rt_store(value);
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  /// Nothing: never stored yet, or the writer was at work at each of `k_attempts` looks.
  [[nodiscard]] std::optional<T> rt_load() const noexcept BITELINE_RT {
    for (int attempt = 0; attempt < k_attempts; ++attempt) {
      const std::uint64_t before = sequence_.load(std::memory_order_acquire);
      if (before == 0) return std::nullopt;
      if (before % 2 != 0) continue;
      const T value = words_.rt_load();
      // Not moved up before the words' acquire loads.
      if (sequence_.load(std::memory_order_relaxed) == before) return value;
    }
    return std::nullopt;
  }

 private:
  // A store takes some 10 ns and comes at most every millisecond; one repeat is normal, more are an
  // interrupted writer.
  static constexpr int k_attempts = 1000;
  std::atomic<std::uint64_t> sequence_{0};
  AtomicWords<T> words_;
};

}  // namespace biteline::rt
