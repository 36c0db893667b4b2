// SPDX-License-Identifier: MIT
#pragma once
/// \file A value as atomic words: may be read while it is written, without a data race (the reader finds out
/// and repeats).

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "common/rt/annotations.hpp"

namespace biteline::rt {

/// Storage of one T for sequence locks (Boehm 2012, "Can seqlocks get along with programming language memory
/// models?"). Every word is stored with release and loaded with acquire: whoever sees one new word also sees
/// what the writer stored before it (the mark "being written"), which makes fences, that the thread sanitizer
/// does not know, needless.
template <class T>
class AtomicWords {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  void rt_store(const T& value) noexcept BITELINE_RT {
    std::array<std::uint64_t, k_words> words{};
    std::memcpy(words.data(), &value, sizeof(T));
    for (std::size_t i = 0; i < k_words; ++i) words_[i].store(words[i], std::memory_order_release);
  }

  /// A mixture of two values if the writer is at work: the caller's sequence check decides.
  [[nodiscard]] T rt_load() const noexcept BITELINE_RT {
    std::array<std::uint64_t, k_words> words;
    for (std::size_t i = 0; i < k_words; ++i) words[i] = words_[i].load(std::memory_order_acquire);
    T value;
    std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
    return value;
  }

 private:
  static constexpr std::size_t k_words = (sizeof(T) + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t);
  std::array<std::atomic<std::uint64_t>, k_words> words_{};
};

}  // namespace biteline::rt
