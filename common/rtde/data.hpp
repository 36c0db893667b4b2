// SPDX-License-Identifier: MIT
#pragma once
/// \file Data packages: the values of one recipe.

#include <span>

#include "common/rtde/fields.hpp"
#include "common/rtde/package.hpp"

namespace biteline::rtde {

/// What both sides agreed on: the types in the order of the names asked for.
struct Recipe {
  std::uint8_t id{0};
  std::vector<std::string> names;
  std::vector<FieldType> types;
};

/// Version 1 outputs have no recipe number in front (one recipe only); inputs always have.
enum class DataHeader { None, RecipeId };

[[nodiscard]] constexpr DataHeader output_header(ProtocolVersion version) {
  return version == ProtocolVersion::V1 ? DataHeader::None : DataHeader::RecipeId;
}

/// Appends one data package.  Pre: one value per field, each of its type.
void append_data(Bytes& out, const Recipe& recipe, std::span<const Value> values, DataHeader header);

/// The recipe a data package belongs to: its index in `recipes`.  Without header: the first.
[[nodiscard]] Result<std::size_t> recipe_of(const Package& package, std::span<const Recipe> recipes,
                                            DataHeader header);

/// Reads the values; the body must be exactly as long as the recipe says.  `values` keeps its capacity from
/// call to call.
[[nodiscard]] Result<void> read_data(const Package& package, const Recipe& recipe, DataHeader header,
                                     std::vector<Value>& values);

}  // namespace biteline::rtde
