// SPDX-License-Identifier: MIT
#include "common/core/text.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace biteline {
namespace {

bool continues(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

/// One letter at the beginning of a text; `bytes` 0: no valid UTF-8 there.
struct Letter {
  std::size_t bytes{0};
  std::uint32_t code{0};
};

Letter first_letter(const char* text, std::size_t size) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {.bytes = 1, .code = lead};
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  // 0xC0, 0xC1 and above 0xF4 begin nothing (RFC 3629); below 0xC2 a byte only continues.
  if (lead < 0xC2 || lead > 0xF4 || bytes > size) return {};
  std::uint32_t code = lead & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if (!continues(text[i])) return {};
    code = (code << 6U) | (static_cast<unsigned char>(text[i]) & 0x3FU);
  }
  constexpr std::uint32_t k_least_of_bytes[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < k_least_of_bytes[bytes] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return {};
  return {.bytes = bytes, .code = code};
}

bool is_plain(std::uint32_t code) {
  const auto among = [code](std::uint32_t first, std::uint32_t last) {
    return code >= first && code <= last;
  };
  return !(code < 0x20 || among(0x7F, 0x9F) || among(0x200E, 0x200F) || among(0x2028, 0x202E) ||
           among(0x2066, 0x2069) || code == 0xFEFF);
}

}  // namespace

std::size_t clean_text_in_place(char* text, std::size_t size) {
  std::size_t to = 0;
  for (std::size_t from = 0; from < size;) {
    const Letter letter = first_letter(text + from, size - from);
    if (letter.bytes == 0 || !is_plain(letter.code)) {
      text[to++] = '?';
      from += std::max<std::size_t>(1, letter.bytes);
      continue;
    }
    std::memmove(text + to, text + from, letter.bytes);
    to += letter.bytes;
    from += letter.bytes;
  }
  return to;
}

std::string_view cut_text(std::string_view text, std::size_t max_bytes) {
  if (text.size() <= max_bytes) return text;
  std::size_t end = max_bytes;
  // A letter has at most three bytes after its first; more of them in a row are no letter.
  for (int back = 0; back < 3 && end > 0 && continues(text[end]); ++back) --end;
  return continues(text[end]) ? text.substr(0, max_bytes) : text.substr(0, end);
}

void shorten_text(char* out, std::size_t capacity, std::string_view text) {
  constexpr std::string_view k_left_out = "...";
  const std::size_t room = capacity - 1 - k_left_out.size();
  const std::string_view head = cut_text(text, room / 3);
  std::string_view tail = text.substr(text.size() - std::min(text.size(), room - head.size()));
  for (int back = 0; back < 3 && !tail.empty() && continues(tail[0]); ++back) tail.remove_prefix(1);
  char* to = std::copy(head.begin(), head.end(), out);
  to = std::copy(k_left_out.begin(), k_left_out.end(), to);
  *std::copy(tail.begin(), tail.end(), to) = '\0';
}

std::string clean_text(std::string_view text, std::size_t max_bytes) {
  std::string out{cut_text(text, max_bytes)};
  out.resize(clean_text_in_place(out.data(), out.size()));
  return out;
}

}  // namespace biteline
