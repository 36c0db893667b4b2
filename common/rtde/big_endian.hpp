// SPDX-License-Identifier: MIT
#pragma once
/// \file Big-endian numbers and texts in byte buffers; the reader cannot leave its span.

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace biteline::rtde {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

namespace detail {

template <class T>
using Carrier =
    std::conditional_t<sizeof(T) == 8, std::uint64_t,
                       std::conditional_t<sizeof(T) == 4, std::uint32_t,
                                          std::conditional_t<sizeof(T) == 2, std::uint16_t, std::uint8_t>>>;

}  // namespace detail

class Writer {
 public:
  explicit Writer(Bytes& out) : out_{out} {}

  template <class T>
  requires std::integral<T> || std::floating_point<T>
  void put(T value) {
    const auto bits = std::bit_cast<detail::Carrier<T>>(value);
    for (int shift = 8 * (static_cast<int>(sizeof(T)) - 1); shift >= 0; shift -= 8) {
      out_.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
  }
  // One by one: GCC 12 takes a range insert into a short vector for an overflow (array-bounds, a false
  // alarm).
  void put_text(std::string_view text) {
    for (const char letter : text) out_.push_back(static_cast<std::uint8_t>(letter));
  }

 private:
  Bytes& out_;
};

/// Every get fails (nothing) beyond the end and stays failed.
class Reader {
 public:
  explicit Reader(ByteView bytes) : bytes_{bytes} {}

  template <class T>
  requires std::integral<T> || std::floating_point<T>
  [[nodiscard]] std::optional<T> get() {
    if (bytes_.size() < sizeof(T)) {
      bytes_ = {};
      failed_ = true;
      return std::nullopt;
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) bits = bits << 8U | bytes_[i];
    bytes_ = bytes_.subspan(sizeof(T));
    return std::bit_cast<T>(static_cast<detail::Carrier<T>>(bits));
  }

  /// The next `size` bytes as text.
  [[nodiscard]] std::optional<std::string> get_text(std::size_t size) {
    if (bytes_.size() < size) {
      bytes_ = {};
      failed_ = true;
      return std::nullopt;
    }
    std::string text(size, '\0');
    if (size > 0) std::memcpy(text.data(), bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
    return text;
  }
  [[nodiscard]] std::string get_rest() { return *get_text(bytes_.size()); }

  [[nodiscard]] std::size_t left() const { return bytes_.size(); }
  [[nodiscard]] bool failed() const { return failed_; }
  /// Everything was there and nothing is left over.
  [[nodiscard]] bool complete() const { return !failed_ && bytes_.empty(); }

 private:
  ByteView bytes_;
  bool failed_{false};
};

}  // namespace biteline::rtde
