// SPDX-License-Identifier: MIT
#pragma once
/// \file Good bytes made bad, without looking at what they do to the code: for machines without libFuzzer,
/// and for whole files.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>

namespace biteline::fuzz {

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_{seed} {}

  std::size_t below(std::size_t count) { return count == 0 ? 0 : random_() % count; }

  /// One to eight changes; `other`: a good input of the same kind, from which pieces are taken.
  [[nodiscard]] std::string mutated(std::string bytes, std::string_view other) {
    constexpr std::array k_changes{1, 1, 1, 2, 3, 8};
    for (int i = k_changes[below(k_changes.size())]; i > 0; --i) change(bytes, other);
    return bytes;
  }

 private:
  void change(std::string& bytes, std::string_view other) {
    const std::size_t at = below(bytes.size() + 1);
    switch (below(8)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes.resize(at);
        break;
      case 2:
        bytes.erase(at, piece());
        break;
      case 3:
        bytes.insert(at, bytes.substr(below(bytes.size() + 1), piece()));
        break;
      case 4:
        bytes.insert(at, other.substr(below(other.size() + 1), piece()));
        break;
      case 5: {
        constexpr std::array<std::string_view, 6> k_words{std::string_view{"\xff\xff\xff\xff", 4},
                                                          {"\0\0\x80\x7f", 4},
                                                          {"\0\0\xc0\x7f", 4},
                                                          {"\0\0\0\0", 4},
                                                          {"\x7f\xff\xff\xff", 4},
                                                          {"\x80\0\0\0", 4}};
        const std::string_view word = k_words[below(k_words.size())];
        if (bytes.size() >= at + word.size()) bytes.replace(at, word.size(), word);
        break;
      }
      case 6:
        change_number(bytes, at);
        break;
      default:
        change_line(bytes, at);
        break;
    }
  }

  std::size_t piece() {
    constexpr std::array<std::size_t, 7> k_lengths{1, 2, 4, 8, 50, 500, 5000};
    return k_lengths[below(k_lengths.size())];
  }

  /// The next number in a text becomes one that nobody means.
  void change_number(std::string& bytes, std::size_t at) {
    constexpr std::string_view k_digits = "0123456789", k_number = "0123456789.eE+-";
    constexpr std::array<std::string_view, 17> k_numbers{"nan",
                                                         ".nan",
                                                         "inf",
                                                         "-1",
                                                         "0",
                                                         "1e308",
                                                         "-1e308",
                                                         "1e39",
                                                         "1e9",
                                                         "99999999999999999999",
                                                         "9223372036854775807",
                                                         "-9223372036854775808",
                                                         "1e-320",
                                                         "-0",
                                                         "",
                                                         "0x10",
                                                         "1e400"};
    const std::size_t begin = bytes.find_first_of(k_digits, at);
    if (begin == std::string::npos) return;
    const std::size_t end = std::min(bytes.size(), bytes.find_first_not_of(k_number, begin));
    const std::size_t which = below(k_numbers.size() + 4);
    const std::string number = which < k_numbers.size()
                                   ? std::string{k_numbers[which]}
                                   : std::to_string(std::ldexp(static_cast<double>(random_() % 2000) - 1000,
                                                               static_cast<int>(below(50)) - 20));
    bytes.replace(begin, end - begin, number);
  }

  /// A line is left out, doubled or moved.
  void change_line(std::string& bytes, std::size_t at) {
    const std::size_t begin = bytes.rfind('\n', at == 0 ? 0 : at - 1);
    if (begin == std::string::npos) return;
    const std::size_t end = std::min(bytes.size(), bytes.find('\n', begin + 1));
    const std::string line = bytes.substr(begin, end - begin);
    if (below(2) == 0) bytes.erase(begin, line.size());
    if (below(2) == 0) bytes.insert(std::min(bytes.size(), bytes.find('\n', below(bytes.size() + 1))), line);
  }

  std::mt19937_64 random_;
};

}  // namespace biteline::fuzz
