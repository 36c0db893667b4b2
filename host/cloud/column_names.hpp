// SPDX-License-Identifier: MIT
#pragma once
/// \file Which column of a table is x, y and z, by the names in its head.

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "host/cloud/length_unit.hpp"

namespace biteline::cloud {

/// Of x, y and z.
struct NamedColumns {
  std::array<std::size_t, 3> field{};
  std::array<std::optional<Unit>, 3> unit{};  ///< as the name says: X[um]
};

/// The three names that are a place's: "x", "X [mm]", "//X", "x_um", "Points:0", "pos_x", "X-Koordinate".
/// Names that only look alike are none: "nx", "Normals:0", "x_index", "px", "vx", "x_err".  Where several
/// triples are there, the plainest one counts.
[[nodiscard]] std::optional<NamedColumns> named_columns(const std::vector<std::string_view>& names);

}  // namespace biteline::cloud
