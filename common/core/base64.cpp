// SPDX-License-Identifier: MIT
#include "common/core/base64.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace biteline {
namespace {

constexpr std::string_view k_letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t k_none = 0xff;

constexpr std::array<std::uint8_t, 256> values() {
  std::array<std::uint8_t, 256> value{};
  value.fill(k_none);
  for (std::size_t i = 0; i < k_letters.size(); ++i)
    value[static_cast<unsigned char>(k_letters[i])] = static_cast<std::uint8_t>(i);
  return value;
}
constexpr std::array<std::uint8_t, 256> k_values = values();

}  // namespace

std::string to_base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? k_letters[group >> (18U - 6U * k) & 63U] : '=';
  }
  return text;
}

std::optional<std::string> from_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t i = 0; i < text.size(); i += 4) {
    const bool last = i + 4 == text.size();
    const std::size_t padding = !last || text[i + 3] != '=' ? 0 : text[i + 2] != '=' ? 1 : 2;
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint8_t value =
          k >= 4 - padding ? std::uint8_t{0} : k_values[static_cast<unsigned char>(text[i + k])];
      if (value == k_none) return std::nullopt;
      group = group << 6U | value;
    }
    const std::uint32_t unused = padding == 0 ? 0U : group & (padding == 1 ? 0xffU : 0xffffU);
    if (unused != 0) return std::nullopt;
    for (std::size_t k = 0; k < 3 - padding; ++k) bytes += static_cast<char>(group >> (16U - 8U * k) & 0xffU);
  }
  return bytes;
}

}  // namespace biteline
