// SPDX-License-Identifier: MIT
#include "common/wire/packing.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace biteline::wire {
namespace {

static_assert(std::endian::native == std::endian::little, "the packed bytes are little-endian");

constexpr std::array<std::array<std::uint8_t, 4>, 2> k_lengths_bytes{{{1, 2, 3, 4}, {0, 1, 2, 4}}};
constexpr std::size_t k_codes_per_byte = 4;

constexpr std::uint32_t zigzag(std::uint32_t difference) {
  return (difference << 1U) ^ (0U - (difference >> 31U));
}

constexpr std::uint32_t unzigzag(std::uint32_t coded) {
  return (coded >> 1U) ^ (0U - (coded & 1U));
}

std::uint32_t length_code(std::uint32_t coded, Lengths lengths) {
  const auto bytes = static_cast<std::uint32_t>(std::bit_width(coded) + 7) / 8;  // 0 .. 4
  if (lengths == Lengths::Dense) return bytes == 0 ? 0 : bytes - 1;
  return bytes == 4 ? 3 : (bytes == 3 ? 3 : bytes);
}

std::size_t code_bytes(std::size_t count) {
  return (count + k_codes_per_byte - 1) / k_codes_per_byte;
}

}  // namespace

void pack(std::span<const std::uint32_t> values, Lengths lengths, std::uint32_t step,
          std::vector<std::uint8_t>& out) {
  const auto& length_bytes = k_lengths_bytes[static_cast<std::size_t>(lengths)];
  const std::size_t codes_at = out.size();
  const std::size_t data_at = codes_at + code_bytes(values.size());
  // Room for the worst case, so that each number can be stored as four bytes and the next one overlap it.
  out.resize(data_at + 4 * values.size(), 0);
  std::uint8_t* data = out.data() + data_at;
  std::uint32_t predicted = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t coded = zigzag(values[i] - predicted);
    const std::uint32_t code = length_code(coded, lengths);
    out[codes_at + i / k_codes_per_byte] |= static_cast<std::uint8_t>(code << (2 * (i % k_codes_per_byte)));
    std::memcpy(data, &coded, sizeof coded);
    data += length_bytes[code];
    predicted = values[i] + step;
  }
  out.resize(static_cast<std::size_t>(data - out.data()));
}

Result<void> unpack(std::span<const std::uint8_t> packed, Lengths lengths, std::uint32_t step,
                    std::span<std::uint32_t> values) {
  const auto& length_bytes = k_lengths_bytes[static_cast<std::size_t>(lengths)];
  const std::size_t codes = code_bytes(values.size());
  if (packed.size() < codes) return fail(Errc::Truncated, "packed column: length codes cut off");
  std::size_t at = codes;
  std::uint32_t predicted = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t code = (packed[i / k_codes_per_byte] >> (2 * (i % k_codes_per_byte))) & 3U;
    const std::size_t bytes = length_bytes[code];
    if (packed.size() - at < bytes) return fail(Errc::Truncated, "packed column: numbers cut off");
    std::uint32_t coded = 0;
    std::memcpy(&coded, packed.data() + at, bytes);
    at += bytes;
    values[i] = predicted + unzigzag(coded);
    predicted = values[i] + step;
  }
  if (at != packed.size()) return fail(Errc::BadFormat, "packed column: bytes left over");
  return {};
}

}  // namespace biteline::wire
