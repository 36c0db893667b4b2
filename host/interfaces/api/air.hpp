// SPDX-License-Identifier: MIT
#pragma once
/// \file What became of a scan's first run in the air.

#include <filesystem>

#include "host/interfaces/control/messages.hpp"

namespace biteline::api {

/// Below a scan's folder: path, gate.json, followed.json as of a real run.
inline constexpr const char* k_air_folder = "air";

/// `AirRun` of the API; null where there was none.
[[nodiscard]] control::Json air_json(const std::filesystem::path& folder);

}  // namespace biteline::api
