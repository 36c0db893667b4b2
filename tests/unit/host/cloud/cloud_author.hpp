// SPDX-License-Identifier: MIT
#pragma once
/// \file What all writers of foreign clouds share: points, choices, ways to write a number.

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

#include "tests/unit/host/cloud/cloud_writers.hpp"

namespace biteline::cloud::writers {

using Place = Eigen::Vector3d;

/// Choices and numbers of one file.
class Author {
 public:
  Author(WrittenCloud& written, std::uint32_t seed) : out{written}, random_{seed} {
    const int count = between(40, 120);
    for (int i = 0; i < count; ++i) {
      // Thousandths, exact in each writer's digits; no sign of a grid.
      points.emplace_back(0.001 * between(-140'000, 140'000), 0.001 * between(-60'000, 60'000),
                          0.001 * between(1, 120'000));
      hole.push_back(with_holes_ && between(0, 9) == 0);
    }
    hole[0] = hole[1] = false;
  }
  int between(int low, int high) { return std::uniform_int_distribution<int>{low, high}(random_); }
  bool maybe() { return between(0, 1) == 1; }
  template <std::size_t N>
  const char* one_of(const std::array<const char*, N>& choices) {
    return choices.at(static_cast<std::size_t>(between(0, static_cast<int>(N) - 1)));
  }
  /// Points with numbers are to be read, the others to be counted.
  void expect() {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (hole[i]) {
        ++out.without_number;
      } else {
        out.points.push_back(points[i]);
      }
    }
  }

  /// A mesh over all points is made small: its surface is sampled.
  void shrink() {
    for (Place& point : points) point = (point * 50).array().round() / 1000;
  }

  WrittenCloud& out;
  std::vector<Place> points;
  std::vector<bool> hole;

 private:
  std::mt19937 random_;
  bool with_holes_ = maybe();
};

inline std::string fixed(double value, int decimals, char decimal = '.') {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  std::string written = text.data();
  std::ranges::replace(written, '.', decimal);
  return written;
}

inline std::string scientific(double value, char letter = 'E', bool plus = false) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), plus ? "%+.10E" : "%.10E", value);
  std::string written = text.data();
  std::ranges::replace(written, 'E', letter);
  return written;
}

inline std::string in_utf16(const std::string& text, bool big_endian) {
  std::string wide = big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) {
    if (big_endian) wide += '\0';
    wide += c;
    if (!big_endian) wide += '\0';
  }
  return wide;
}

inline std::string with_line_ends(const std::string& text, const char* end) {
  std::string other;
  for (const char c : text) {
    if (c == '\n')
      other += end;
    else
      other += c;
  }
  return other;
}

template <class T>
void put_raw(std::string& bytes, T value, bool big_endian = false) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof value);
  if (big_endian) std::ranges::reverse(raw);
  bytes.append(raw.data(), raw.size());
}

/// Each writes a file of its own program's habits.
void cloud_compare(Author& by);
void excel(Author& by);
void pandas(Author& by);
void paraview(Author& by);
void matlab(Author& by);
void fortran(Author& by);
void old_windows(Author& by);
void metrology(Author& by);
void mixed_units(Author& by);
void pts(Author& by);
void r_table(Author& by);
void ply(Author& by);
void pcd(Author& by);
void stl(Author& by);
void obj(Author& by);

}  // namespace biteline::cloud::writers
