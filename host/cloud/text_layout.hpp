// SPDX-License-Identifier: MIT
#pragma once
/// \file How one text cloud is written: found from its first rows, before a point is read.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/result.hpp"
#include "host/cloud/length_unit.hpp"

namespace biteline::cloud {

struct TextLayout {
  char separator{' '};  ///< k_blanks: any number of blanks and tabs
  char decimal{'.'};
  std::size_t fields{0};                      ///< in a row
  std::array<std::size_t, 3> columns{};       ///< fields that are x, y, z
  bool named{false};                          ///< by a head
  std::array<std::optional<Unit>, 3> unit{};  ///< of x, y, z, as the head says
  std::size_t first_row{1};                   ///< the first point's row
  std::optional<std::uint64_t> promised;      ///< points, as a row before them says

  /// "columns 2 to 4 of 7, tabs between, decimal comma".
  [[nodiscard]] std::string words() const;
};

/// Begins a comment, in front of points or among them.
[[nodiscard]] bool is_comment(std::string_view row);
/// A whole number alone in its row: how many points follow.
[[nodiscard]] std::optional<std::uint64_t> lone_count(std::string_view row);

/// One separator and one decimal sign for the whole file; the head's names, or the first three columns of
/// numbers.  Refuses, in one sentence, what is no list of points: a grid of heights, two columns, names
/// without x, y and z.
[[nodiscard]] Result<TextLayout> text_layout(std::string_view text, const std::filesystem::path& file);

}  // namespace biteline::cloud
