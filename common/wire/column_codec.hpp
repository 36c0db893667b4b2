// SPDX-License-Identifier: MIT
#pragma once
/// \file Columns of numbers as the schema's packed byte vectors (PROTOCOL.md, "Packed columns").  Private to
/// common/wire.

#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/core/numbers.hpp"
#include "common/core/result.hpp"
#include "common/wire/packing.hpp"
#include "common/wire/protocol_generated.h"

namespace biteline::wire {

using PackedColumn = flatbuffers::Vector<std::uint8_t>;
using ColumnOffset = flatbuffers::Offset<PackedColumn>;

/// How one column is packed.
struct ColumnForm {
  Lengths lengths{Lengths::Dense};
  std::uint32_t step{0};
};

inline constexpr ColumnForm k_measured{.lengths = Lengths::Dense, .step = 0};
inline constexpr ColumnForm k_constant{.lengths = Lengths::Sparse, .step = 0};
/// Image columns mostly follow one another.
inline constexpr ColumnForm k_counting{.lengths = Lengths::Sparse, .step = 1};

/// `bits_of(row)` is the column's number as 32 bits.
template <class Row, class BitsOf>
ColumnOffset pack_column(flatbuffers::FlatBufferBuilder& fbb, std::span<const Row> rows, ColumnForm form,
                         BitsOf&& bits_of) {
  thread_local std::vector<std::uint32_t> numbers;
  thread_local std::vector<std::uint8_t> packed;
  numbers.clear();
  for (const Row& row : rows) numbers.push_back(bits_of(row));
  packed.clear();
  pack(numbers, form.lengths, form.step, packed);
  return fbb.CreateVector(packed.data(), packed.size());
}

template <class Row, class Member>
ColumnOffset pack_floats(flatbuffers::FlatBufferBuilder& fbb, std::span<const Row> rows, Member&& member) {
  return pack_column(fbb, rows, k_measured,
                     [&](const Row& row) { return std::bit_cast<std::uint32_t>(float{member(row)}); });
}

/// `store(row, bits)` puts one number back, and is false when it cannot be one.  `name` says whose column it
/// is.
template <class Row, class Store>
Result<void> unpack_column(const PackedColumn* packed, ColumnForm form, const char* name, std::span<Row> rows,
                           Store&& store) {
  thread_local std::vector<std::uint32_t> numbers;
  numbers.resize(rows.size());
  const std::span<const std::uint8_t> bytes =
      packed == nullptr ? std::span<const std::uint8_t>{} : std::span{packed->data(), packed->size()};
  if (!unpack(bytes, form.lengths, form.step, numbers)) {
    return fail(Errc::ProtocolError, "column %s is not as long as its points", name);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!store(rows[i], numbers[i])) return fail(Errc::ProtocolError, "impossible number in column %s", name);
  }
  return {};
}

template <class Row, class Member>
Result<void> unpack_floats(const PackedColumn* packed, const char* name, std::span<Row> rows,
                           Member&& member) {
  return unpack_column(packed, k_measured, name, rows, [&](Row& row, std::uint32_t bits) {
    const auto number = std::bit_cast<float>(bits);
    member(row) = number;
    return NumberRange{}.holds(number);
  });
}

template <class Integer, class Row, class Member>
Result<void> unpack_integers(const PackedColumn* packed, ColumnForm form, const char* name,
                             std::span<Row> rows, Member&& member) {
  return unpack_column(packed, form, name, rows, [&](Row& row, std::uint32_t bits) {
    member(row) = static_cast<Integer>(bits);
    return bits <= std::numeric_limits<Integer>::max();
  });
}

}  // namespace biteline::wire
