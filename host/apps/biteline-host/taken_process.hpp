// SPDX-License-Identifier: MIT
#pragma once
/// \file A process as it was read: planned with, kept beside its scan (transfer::k_process_file), and
/// compared before its path is sent.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::service {

struct TakenProcess {
  path::Process process;
  std::string text;    ///< of its file, whole
  std::string sha256;  ///< of that text
  std::filesystem::path file;
};

/// Once: what is planned and what is kept come of the same bytes.
[[nodiscard]] Result<TakenProcess> take_process(const std::filesystem::path& file);

}  // namespace biteline::service
