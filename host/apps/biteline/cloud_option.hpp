// SPDX-License-Identifier: MIT
#pragma once
/// \file --unit, and the clouds that commands read.

#include <optional>

#include "common/options/command.hpp"
#include "host/cloud/cloud_file.hpp"

namespace biteline::app {

/// What a command says of its cloud in --help.
inline constexpr const char* k_cloud_kinds = "PLY, XYZ, CSV, PCD, STL or OBJ; mm, or as --unit says";

/// `--unit mm|m|in`: the unit of the cloud that the command reads.
void add_unit_option(options::Command& command, std::optional<cloud::Unit>& unit);

}  // namespace biteline::app
