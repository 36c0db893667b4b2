// SPDX-License-Identifier: MIT
#pragma once
/// \file What of a board answers, and the step for what does not.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::sensor {

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
