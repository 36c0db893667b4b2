// SPDX-License-Identifier: MIT
#pragma once
/// \file Lines that lie where their cloud lay: in a map's grid thousands of kilometres from the origin.

#include "host/cloud/closed_line.hpp"

namespace biteline::cloud {

/// As read_line() and read_positions(), with places up to 100 000 km.  For those who measure and write lines;
/// what an arm follows lies near.
[[nodiscard]] Result<ClosedLine> read_far_line(const std::filesystem::path& file);
[[nodiscard]] Result<ClosedLine> read_far_positions(const std::filesystem::path& file);

}  // namespace biteline::cloud
