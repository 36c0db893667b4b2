// SPDX-License-Identifier: MIT
#pragma once
/// \file A board's devices as a source, opened as its board.yaml says.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "firmware/app/source.hpp"

namespace biteline::sensor {

/// Errc::NotSupported where the board has what this program was built without.
[[nodiscard]] Result<std::unique_ptr<SourceKind>> open_board(const std::filesystem::path& board_file,
                                                             const std::filesystem::path& sensor_file);

/// One device of a board, opened and closed again.
struct DeviceFinding {
  std::string what;
  bool ready{false};
  std::string seen;
  std::string step;  ///< empty when ready
};

/// Every device that the board names, and the rights that the threads need; the board's sensor program must
/// not be running. The watchdog is only looked at: opened, it would have to be fed.
[[nodiscard]] Result<std::vector<DeviceFinding>> check_board(const std::filesystem::path& board_file);

}  // namespace biteline::sensor
