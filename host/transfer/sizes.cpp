// SPDX-License-Identifier: MIT
#include "host/transfer/sizes.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

#include "common/core/fixed_text.hpp"

namespace biteline::transfer {
namespace {

struct System {
  const char* name;
  double mm_per_size;
};
constexpr std::array k_systems{System{"EU", 20.0 / 3}, System{"UK", 25.4 / 3}, System{"US", 25.4 / 3},
                               System{"JP", 10},       System{"CM", 10},       System{"MP", 1},
                               System{"MONDO", 1}};

constexpr double k_most_number = 500;
// A last is made to its size within some tenths of a millimetre; half a size is 3.3 mm and more.
constexpr double k_most_off_sizes = 0.2;

}  // namespace

std::optional<SizeLabel> size_label(std::string_view text) {
  SizeLabel label;
  std::string number;
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalpha(u) != 0 && number.empty())
      label.system += static_cast<char>(std::toupper(u));
    else if (std::isdigit(u) != 0 || c == '.' || c == ',')
      number += c == ',' ? '.' : c;
    else if (c != ' ')
      return std::nullopt;
  }
  const char* end = number.data() + number.size();
  const auto [at, error] = std::from_chars(number.data(), end, label.number);
  if (error != std::errc{} || at != end || !(label.number > 0 && label.number < k_most_number))
    return std::nullopt;
  return label;
}

std::string text_of(const SizeLabel& label) {
  const auto number = FixedText<32>::format("%g", label.number);
  return label.system.empty() ? std::string{number.c_str()} : label.system + " " + number.c_str();
}

std::optional<double> mm_per_size(const SizeLabel& label) {
  const auto* const found = std::ranges::find(k_systems, label.system, &System::name);
  if (found == k_systems.end()) return std::nullopt;
  return found->mm_per_size;
}

std::optional<SizeLabel> SizeScale::at(double change) const {
  const double number = number_at(change);
  const double half = std::round(2 * number) / 2;
  if (std::abs(number - half) > k_most_off_sizes) return std::nullopt;
  return SizeLabel{.system = of_sample.system, .number = half};
}

}  // namespace biteline::transfer
