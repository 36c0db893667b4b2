// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline model release`: models and processes of a factory as one file, and the text that is
/// signed.

#include <filesystem>
#include <string>
#include <vector>

#include "host/apps/biteline/command.hpp"

namespace biteline::app {

struct ReleaseOrder {
  std::string name;
  std::filesystem::path out;
  std::vector<std::string> models;  ///< empty: all of the library
  std::vector<std::filesystem::path> processes;
};

/// Each model and process is read as the cell will read it.  Writes the file and its manifest; the signature
/// is made by who has the key.
[[nodiscard]] Result<ExitStatus> write_release(const ReleaseOrder& order,
                                               const std::filesystem::path& library,
                                               const GlobalOptions& global);

}  // namespace biteline::app
