// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline history --verify-log`: whether the memory's log is as it was written.

#include <filesystem>

#include "host/apps/biteline/command.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::app {

/// `kept`: a file of links, empty: none.  Where the log holds, its newest link is added to the file.
[[nodiscard]] Result<ExitStatus> verify_log(const memory::Memory& memory, const std::filesystem::path& kept,
                                            const GlobalOptions& global);

}  // namespace biteline::app
