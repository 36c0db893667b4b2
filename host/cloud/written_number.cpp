// SPDX-License-Identifier: MIT
#include "host/cloud/written_number.hpp"

#include <algorithm>
#include <array>

namespace biteline::cloud {
namespace {

constexpr std::string_view k_digits = "0123456789";
constexpr std::string_view k_minus = "\xE2\x88\x92";  // as typesetters write it

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view k_around = " \t\r\n";
  const auto begin = text.find_first_not_of(k_around);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(k_around) + 1 - begin);
}

Written unusual_number(std::string_view text, char decimal, double& value) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    text = trimmed(text.substr(1, text.size() - 2));
  // Old Windows writes 1.#QNAN and -1.#IND, tables #DIV/0!.
  if (text.find_first_of(k_digits) == std::string_view::npos || text.starts_with('#') ||
      text.find(".#") != std::string_view::npos || text.find(",#") != std::string_view::npos)
    return Written::Nothing;

  std::array<char, 64> plain{};
  std::size_t size = 0;
  if (text.starts_with(k_minus)) {
    plain[size++] = '-';
    text.remove_prefix(k_minus.size());
  } else if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return Written::Wrong;
  }
  bool exponent = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (size + 2 >= plain.size()) return Written::Wrong;
    const bool letter = (c | 0x20) == 'e' || (c | 0x20) == 'd';
    // Fortran leaves the letter out where the exponent has three digits: 0.12-101.
    const bool left_out = (c == '+' || c == '-') && text.size() == i + 4 &&
                          std::find(plain.begin(), plain.begin() + size, '.') != plain.begin() + size;
    if (!exponent && (letter || left_out)) {
      plain[size++] = 'e';
      if (left_out) plain[size++] = c;
      exponent = true;
    } else if (c == decimal) {
      plain[size++] = '.';
    } else if (c == '.' || c == ',') {
      return Written::Wrong;
    } else {
      plain[size++] = c;
    }
  }
  double read = 0;
  const auto [end, status] = std::from_chars(plain.data(), plain.data() + size, read);
  const bool nan_with_a_number = std::string_view{plain.data(), size}.find_first_of("nN") < 2;
  if (nan_with_a_number && (status == std::errc{} || end != plain.data())) return Written::Nothing;
  if (end != plain.data() + size || status == std::errc::invalid_argument) return Written::Wrong;
  if (status == std::errc::result_out_of_range) {
    const bool tiny = std::string_view{plain.data(), size}.find("e-") != std::string_view::npos;
    if (!tiny) return Written::Nothing;
    read = 0;
  }
  if (!std::isfinite(read)) return Written::Nothing;
  value = read;
  return Written::Number;
}

}  // namespace biteline::cloud
