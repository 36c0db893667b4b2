// SPDX-License-Identifier: MIT
#pragma once
/// \file Writes CDR, the form of ROS 2's messages (OMG CORBA 3.0, 15.3): little-endian, no options.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace biteline::recording {

/// Behind the encapsulation's head of four bytes; alignment counts from there.
inline constexpr std::size_t k_cdr_head_bytes = 4;

class CdrWriter {
 public:
  explicit CdrWriter(std::size_t bytes = 64) { out_.reserve(bytes); }

  template <class Number>
  requires std::is_arithmetic_v<Number>
  void put(Number value) {
    align(sizeof value);
    put_raw(value);
  }
  /// Also bytes: a length and as many.
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    out_.insert(out_.end(), text.begin(), text.end());
    out_.push_back(0);
  }
  void put_bytes(std::span<const std::uint8_t> bytes) {
    put(static_cast<std::uint32_t>(bytes.size()));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  /// std_msgs/Header: of a time in ns since 1970 or any other zero, and a frame's name.
  void put_header(std::int64_t stamp_ns, std::string_view frame) {
    constexpr std::int64_t k_second = 1'000'000'000;
    const std::int64_t rest = ((stamp_ns % k_second) + k_second) % k_second;
    put(static_cast<std::int32_t>((stamp_ns - rest) / k_second));
    put(static_cast<std::uint32_t>(rest));
    put_text(frame);
  }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(out_); }

 private:
  void align(std::size_t size) {
    while ((out_.size() - k_cdr_head_bytes) % size != 0) out_.push_back(0);
  }
  template <class Number>
  void put_raw(Number value) {
    std::uint8_t raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);  // the machines that this is built for are little-endian
    out_.insert(out_.end(), raw, raw + sizeof value);
  }

  std::vector<std::uint8_t> out_{0, 1, 0, 0};
};

}  // namespace biteline::recording
