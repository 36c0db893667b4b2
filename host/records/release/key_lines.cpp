// SPDX-License-Identifier: MIT
#include "host/records/release/key_lines.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace biteline::release {
namespace {

constexpr std::int64_t k_most_number = 1LL << 53;

}  // namespace

bool is_sha256(std::string_view text) {
  return text.size() == 64 && std::ranges::all_of(text, [](char digit) {
           return (digit >= '0' && digit <= '9') || (digit >= 'a' && digit <= 'f');
         });
}

bool is_release_name(std::string_view text) {
  return !text.empty() && text.size() <= 64 && text.front() != '.' &&
         std::ranges::all_of(text, [](unsigned char letter) {
           return letter < 128 &&
                  (std::isalnum(letter) != 0 || letter == '.' || letter == '_' || letter == '-');
         });
}

std::string_view KeyLines::value(std::string_view key) {
  const std::size_t end = rest_.find('\n');
  const std::string_view line = rest_.substr(0, end);
  if (end == std::string_view::npos || line.size() <= key.size() + 1 || !line.starts_with(key) ||
      line[key.size()] != ' ') {
    fault(key);
    return {};
  }
  rest_.remove_prefix(end + 1);
  return line.substr(key.size() + 1);
}

std::string KeyLines::hash_if(std::string_view key) {
  const std::string_view text = value(key);
  if (text == "-") return {};
  if (!is_sha256(text)) fault(key);
  return std::string{text};
}

std::int64_t KeyLines::whole(std::string_view key) {
  const std::string_view text = value(key);
  std::int64_t number = 0;
  const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || at != text.data() + text.size() || number < 0 || number > k_most_number)
    fault(key);
  return number;
}

void KeyLines::fault(std::string_view key) {
  if (wrong_.empty()) wrong_ = key;
}

Result<void> KeyLines::finish() {
  if (wrong_.empty() && !rest_.empty()) wrong_ = "what follows the last line";
  if (wrong_.empty()) return {};
  return fail(Errc::BadFormat, "%.100s: '%.60s' is not as expected", what_, wrong_.c_str());
}

}  // namespace biteline::release
