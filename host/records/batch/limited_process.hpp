// SPDX-License-Identifier: MIT
#pragma once
/// \file A program under limits of time and memory, and what it used.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::batch {

struct ProcessLimits {
  double time_s{600};      ///< by the clock on the wall; then it and all it started are killed
  double memory_mb{4096};  ///< of data, each process for itself; beyond, it gets no more
};

struct ProcessEnd {
  enum class How { Exited, Signalled, TimedOut };
  How how{How::Exited};
  int status{0};           ///< exit status, or the signal's number
  std::string last_words;  ///< the last line of its stderr
  double wall_s{0};
  double cpu_s{0};  ///< of it and of those it waited for
  double peak_memory_mb{0};
};

/// Runs `program` to its end with stdout thrown away and stderr in `folder`/stderr.txt.  It dies with
/// the calling thread.  Fails only when it cannot be started.
[[nodiscard]] Result<ProcessEnd> run_limited(const std::filesystem::path& program,
                                             const std::vector<std::string>& arguments,
                                             const std::filesystem::path& folder,
                                             const ProcessLimits& limits);

}  // namespace biteline::batch
