// SPDX-License-Identifier: MIT
#include "host/records/archive/tar_block.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>

namespace biteline::archive::tar {
namespace {

void put(Block& block, const Field& field, const std::string& text) {
  std::memcpy(block.data() + field.at, text.data(), std::min(field.bytes, text.size()));
}
void put_octal(Block& block, const Field& field, std::uint64_t number) {
  char text[24];
  std::snprintf(text, sizeof text, "%0*llo", static_cast<int>(field.bytes - 1),
                static_cast<unsigned long long>(number));
  put(block, field, text);
}

}  // namespace

bool good_name(const std::string& name) {
  if (name.empty() || name.size() >= k_name.bytes || name.front() == '/' || name.back() == '/') return false;
  bool part_begins = true;
  for (const char c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    if (!plain && c != '/' && c != '.') return false;
    if (part_begins && (c == '.' || c == '/')) return false;
    part_begins = c == '/';
  }
  return true;
}

std::uint64_t sum_of(Block block) {
  std::fill_n(block.begin() + k_sum.at, k_sum.bytes, ' ');
  std::uint64_t sum = 0;
  for (const char c : block) sum += static_cast<unsigned char>(c);
  return sum;
}

Block header_of(const std::string& name, std::uint64_t bytes) {
  Block block{};
  put(block, k_name, name);
  put_octal(block, k_mode, 0600);
  put_octal(block, k_owner, 0);
  put_octal(block, k_group, 0);
  put_octal(block, k_size, bytes);
  put_octal(block, k_time, 0);
  put(block, k_kind, "0");
  put(block, k_magic,
      std::string{"ustar\0"
                  "00",
                  8});
  put_octal(block, {k_sum.at, 7}, sum_of(block));
  block[k_sum.at + 7] = ' ';
  return block;
}

}  // namespace biteline::archive::tar
