// SPDX-License-Identifier: MIT
#pragma once
/// \file Wear of a tool by its name, over all models and processes that it pressed.

#include <optional>
#include <span>
#include <string>

#include "host/records/force_book/force_book.hpp"
#include "host/study/wear.hpp"

namespace biteline::force_book {

struct ToolWear {
  int shoes{0};  ///< pressed since then, as far as they are kept
  /// Of the tip's place along the force, mm with each shoe: at a set force a worn tool goes farther in.
  /// Nothing: too few shoes.
  std::optional<study::Trend> trend{};
};

/// Each model, foot and process has a level of its own, the slope is one.
/// \param since  when its disc, brush or roller was renewed; 0: of all that is kept
[[nodiscard]] ToolWear wear_of_tool(std::span<const Entry> entries, const std::string& tool,
                                    memory::UnixMs since);

/// {"shoes", "mm_per_shoe", "u95_mm_per_shoe", "sure"}; without a trend the last three are null.
[[nodiscard]] nlohmann::ordered_json to_json(const ToolWear& wear);
[[nodiscard]] std::string words_of(const ToolWear& wear);

}  // namespace biteline::force_book
