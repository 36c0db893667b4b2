// SPDX-License-Identifier: MIT
#pragma once
/// \file What the fleet's two programs share: they run until they are told to stop.

#include <atomic>
#include <string>

#include "common/core/error.hpp"

namespace biteline::fleet {

/// Set by SIGTERM and SIGINT.
[[nodiscard]] const std::atomic<bool>& told_to_stop();

/// One line on stderr under the program's name, and the exit status for `return`.
int log_error(const char* program, const std::string& line, ExitStatus status);

/// Runs `run(argc, argv)` under the signals above; an exception ends in one line.
int run_until_told(const char* program, int argc, char** argv, int (*run)(int, char**));

}  // namespace biteline::fleet
