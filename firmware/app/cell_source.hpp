// SPDX-License-Identifier: MIT
#pragma once
/// \file The simulated cell as a source: a GigE Vision camera on the network, lines and pose bus over
/// simulated wires.

#include <filesystem>
#include <memory>
#include <string>

#include "firmware/app/source.hpp"
#include "hal/api/clock.hpp"

namespace biteline::sensor {

/// "NAME" or "NAME,camera=ADDRESS": the cell's wires, and where its camera answers (default 127.0.0.1).
/// The head's settings come from `sensor_file`, which must say rate and exposure.
[[nodiscard]] Result<std::unique_ptr<SourceKind>> open_cell(const std::string& address,
                                                            const std::filesystem::path& sensor_file);

}  // namespace biteline::sensor
