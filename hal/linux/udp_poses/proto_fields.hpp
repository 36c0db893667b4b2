// SPDX-License-Identifier: MIT
#pragma once
/// \file One level of a Protocol Buffers message, field by field, without a schema.

#include <bit>
#include <cstdint>
#include <optional>
#include <span>

namespace biteline::hal {

/// Walks over the bytes of one message.  Memory: none; the bytes are borrowed.
class ProtoFields {
 public:
  enum class Type : std::uint8_t { Varint = 0, Fixed64 = 1, Bytes = 2, Fixed32 = 5 };
  struct Field {
    std::uint64_t number{0};
    Type type{Type::Varint};
    std::uint64_t value{0};                 ///< Varint, Fixed64, Fixed32
    std::span<const std::uint8_t> bytes{};  ///< Bytes

    [[nodiscard]] double as_double() const { return std::bit_cast<double>(value); }
  };

  explicit ProtoFields(std::span<const std::uint8_t> message) : rest_{message} {}

  /// The next field; nothing at the end, or where the bytes are no message (whole() tells).
  [[nodiscard]] std::optional<Field> next();
  /// All bytes were fields so far.
  [[nodiscard]] bool whole() const { return whole_; }

 private:
  [[nodiscard]] std::optional<std::uint64_t> varint();
  /// Little-endian, of `count` bytes, at most 8.
  [[nodiscard]] std::optional<std::uint64_t> fixed(std::size_t count);
  [[nodiscard]] std::optional<Field> field();

  std::span<const std::uint8_t> rest_;
  bool whole_{true};
};

}  // namespace biteline::hal
