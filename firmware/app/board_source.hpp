// SPDX-License-Identifier: MIT
#pragma once
/// \file A board's devices as a source, opened as its board.yaml says.

#include <filesystem>
#include <memory>

#include "firmware/app/source.hpp"

namespace biteline::sensor {

/// Errc::NotSupported where the board has what this program was built without.
[[nodiscard]] Result<std::unique_ptr<SourceKind>> open_board(const std::filesystem::path& board_file,
                                                             const std::filesystem::path& sensor_file);

}  // namespace biteline::sensor
