// SPDX-License-Identifier: MIT
#include "common/wire/checksum.hpp"

#include <array>
#include <cstddef>
#include <cstring>

namespace biteline::wire {
namespace {

constexpr std::uint32_t k_polynomial = 0x82F63B78;  // 0x1EDC6F41, bits reversed
constexpr std::size_t k_slices = 8;
using Tables = std::array<std::array<std::uint32_t, 256>, k_slices>;

/// Table k gives the effect of a byte that k more bytes follow (M. Kounavis, F. Berry 2005, "slicing by 8").
constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? k_polynomial : 0U);
    tables[0][byte] = crc;
  }
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    for (std::size_t slice = 1; slice < k_slices; ++slice) {
      const std::uint32_t crc = tables[slice - 1][byte];
      tables[slice][byte] = (crc >> 8U) ^ tables[0][crc & 0xFFU];
    }
  }
  return tables;
}

constexpr Tables k_tables = make_tables();

}  // namespace

std::uint32_t crc32c(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = ~0U;
  std::size_t at = 0;
  for (; at + k_slices <= bytes.size(); at += k_slices) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, sizeof word);  // little-endian, as the packing asserts
    word ^= crc;
    crc = 0;
    for (std::size_t slice = 0; slice < k_slices; ++slice) {
      crc ^= k_tables[k_slices - 1 - slice][(word >> (8 * slice)) & 0xFFU];
    }
  }
  for (; at < bytes.size(); ++at) crc = (crc >> 8U) ^ k_tables[0][(crc ^ bytes[at]) & 0xFFU];
  return ~crc;
}

}  // namespace biteline::wire
