// SPDX-License-Identifier: MIT
#include "common/rtde/data.hpp"

#include <type_traits>

#include "common/core/contracts.hpp"

namespace biteline::rtde {
namespace {

template <class T>
void put(Writer& writer, const T& value) {
  writer.put(value);
}
void put(Writer& writer, bool value) {
  writer.put(static_cast<std::uint8_t>(value ? 1 : 0));
}
template <class T, std::size_t Size>
void put(Writer& writer, const std::array<T, Size>& values) {
  for (const T value : values) writer.put(value);
}

template <class T>
void get(Reader& reader, T& value) {
  value = reader.get<T>().value_or(T{});
}
void get(Reader& reader, bool& value) {
  value = reader.get<std::uint8_t>().value_or(0) != 0;
}
template <class T, std::size_t Size>
void get(Reader& reader, std::array<T, Size>& values) {
  for (T& value : values) value = reader.get<T>().value_or(T{});
}

}  // namespace

void append_data(Bytes& out, const Recipe& recipe, std::span<const Value> values, DataHeader header) {
  BITELINE_EXPECTS(values.size() == recipe.types.size());
  const std::size_t start = out.size();
  Writer writer{out};
  writer.put(std::uint16_t{0});
  writer.put(static_cast<std::uint8_t>(PackageType::Data));
  if (header == DataHeader::RecipeId) writer.put(recipe.id);
  for (std::size_t i = 0; i < values.size(); ++i) {
    BITELINE_EXPECTS(values[i].index() == static_cast<std::size_t>(recipe.types[i]));
    std::visit([&](const auto& value) { put(writer, value); }, values[i]);
  }
  const std::size_t size = out.size() - start;
  BITELINE_EXPECTS(size <= k_max_package_bytes);
  out[start] = static_cast<std::uint8_t>(size >> 8U);
  out[start + 1] = static_cast<std::uint8_t>(size);
}

Result<std::size_t> recipe_of(const Package& package, std::span<const Recipe> recipes, DataHeader header) {
  if (recipes.empty()) return fail(Errc::ProtocolError, "RTDE data before any recipe");
  if (header == DataHeader::None) return 0;
  if (package.payload.empty()) return fail(Errc::ProtocolError, "RTDE data package without a recipe number");
  for (std::size_t i = 0; i < recipes.size(); ++i) {
    if (recipes[i].id == package.payload[0]) return i;
  }
  return fail(Errc::ProtocolError, "RTDE data of recipe %u, which nobody asked for",
              static_cast<unsigned>(package.payload[0]));
}

Result<void> read_data(const Package& package, const Recipe& recipe, DataHeader header,
                       std::vector<Value>& values) {
  Reader reader{package.payload};
  if (header == DataHeader::RecipeId) static_cast<void>(reader.get<std::uint8_t>());
  values.resize(recipe.types.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].index() != static_cast<std::size_t>(recipe.types[i])) values[i] = zero_of(recipe.types[i]);
    std::visit([&](auto& value) { get(reader, value); }, values[i]);
  }
  if (!reader.complete()) {
    return fail(Errc::ProtocolError, "RTDE data of recipe %u: %zu bytes do not fit its %zu fields",
                static_cast<unsigned>(recipe.id), package.payload.size(), recipe.types.size());
  }
  return {};
}

}  // namespace biteline::rtde
