// SPDX-License-Identifier: MIT
#pragma once
/// \file What of a board answers, and the step for what does not.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "firmware/app/source.hpp"

namespace biteline::sensor {

/// One device of a board, opened and closed again.
struct DeviceFinding {
  std::string what;
  bool ready{false};
  std::string seen;
  std::string step;  ///< empty when ready
};

/// Every device that the board names, and the rights that the threads need; the board's sensor program must
/// not be running.  The camera is started for a few frames; the laser stays dark. The watchdog is only looked
/// at: opened, it would have to be fed. A set among the options is told to the camera of the head that they
/// name, and read back.
[[nodiscard]] Result<std::vector<DeviceFinding>> check_board(const std::filesystem::path& board_file,
                                                             const SourceOptions& options);

}  // namespace biteline::sensor
