// SPDX-License-Identifier: MIT
#pragma once
/// \file Names and types of the variables that RTDE exchanges.
///
/// Universal Robots, "Real-Time Data Exchange (RTDE)", manual of PolyScope X 10.10, tables of the robot
/// controller's inputs and outputs (universal-robots.com/manuals/EN/HTML/SW10_10); names and types compared
/// with those that Universal Robots' own client library knows (Universal_Robots_Client_Library, 2026).
/// Units are the controller's: m, rad, s.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::rtde {

using Vector3 = std::array<double, 3>;
using Vector6 = std::array<double, 6>;
using Vector6Int32 = std::array<std::int32_t, 6>;
using Vector6Uint32 = std::array<std::uint32_t, 6>;

/// In the order of FieldType: `value.index()` is its type.
using Value = std::variant<bool, std::uint8_t, std::uint32_t, std::uint64_t, std::int32_t, double, Vector3,
                           Vector6, Vector6Int32, Vector6Uint32>;

enum class FieldType : std::uint8_t {
  Bool,
  Uint8,
  Uint32,
  Uint64,
  Int32,
  Double,
  Vector3d,
  Vector6d,
  Vector6i,
  Vector6u,
};

/// What a client asks for: a name, and the type that its code reads under that name.
struct Variable {
  std::string name;
  FieldType type{};
};

/// The type's name on the wire ("VECTOR6D") and back.
[[nodiscard]] std::string_view wire_name(FieldType type);
[[nodiscard]] std::optional<FieldType> field_type_of(std::string_view wire_name);

/// A value of that type, zero.
[[nodiscard]] Value zero_of(FieldType type);

/// What a controller of the e series or CB3 sends or takes under that name; nothing for other names.
[[nodiscard]] std::optional<FieldType> output_type(std::string_view name);
[[nodiscard]] std::optional<FieldType> input_type(std::string_view name);

/// All of them.
[[nodiscard]] std::vector<std::string> output_names();
[[nodiscard]] std::vector<std::string> input_names();

/// Comma-separated lists, as in the set-up packages.
[[nodiscard]] std::string join(const std::vector<std::string>& names);
[[nodiscard]] std::vector<std::string> split(std::string_view list);

}  // namespace biteline::rtde
