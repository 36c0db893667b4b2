// SPDX-License-Identifier: MIT
#pragma once
/// \file Sizes as shoes are marked with, and what one takes in length.

#include <optional>
#include <string>
#include <string_view>

namespace biteline::transfer {

/// "EU 42.5": system and number.  A system is letters, or nothing.
struct SizeLabel {
  std::string system{};
  double number{0};
};

/// Nothing where the text is no size: "42", "EU 42", "uk 8,5" are some.
[[nodiscard]] std::optional<SizeLabel> size_label(std::string_view text);
[[nodiscard]] std::string text_of(const SizeLabel& label);

/// By how much a last of the next whole size is longer, mm: Paris points (EU), thirds of an inch (UK, US),
/// centimetres (JP, CM), millimetres (MP, MONDO).  Nothing for other systems.
[[nodiscard]] std::optional<double> mm_per_size(const SizeLabel& label);

/// Sizes of one model: a sample's, and the share of its length that one size takes.
struct SizeScale {
  SizeLabel of_sample{};
  double share_per_size{0};

  /// Of a shoe that is longer than the sample by this share of its length.
  [[nodiscard]] double number_at(double change) const { return of_sample.number + change / share_per_size; }
  /// The half size there; nothing where the shoe lies between two, farther than a fifth of a size from each.
  [[nodiscard]] std::optional<SizeLabel> at(double change) const;
};

}  // namespace biteline::transfer
