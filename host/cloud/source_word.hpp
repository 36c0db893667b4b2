// SPDX-License-Identifier: MIT
#pragma once
/// \file How files name the source of a point.

#include <string_view>

#include "host/cloud/closed_line.hpp"

namespace biteline::cloud {

/// "seen", "bridged", "carried" or "mended".
[[nodiscard]] std::string_view source_word(PointSource source);

}  // namespace biteline::cloud
