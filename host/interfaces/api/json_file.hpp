// SPDX-License-Identifier: MIT
#pragma once
/// \file A result's JSON file.

#include <filesystem>

#include "host/interfaces/control/messages.hpp"

namespace biteline::api {

/// Null when there is none, or when it is no JSON.
[[nodiscard]] control::Json file_json(const std::filesystem::path& file);

}  // namespace biteline::api
