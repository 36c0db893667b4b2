// SPDX-License-Identifier: MIT
#pragma once
/// \file A session, or a scan's messages, as one MCAP file.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/core/result.hpp"

namespace biteline::recording {

struct ExportOptions {
  std::filesystem::path input;    ///< a session's folder, or scan.btln
  std::filesystem::path out;      ///< nothing of that name may exist
  std::filesystem::path results;  ///< a result folder whose verdict goes along; empty: none
  std::string library;            ///< who writes, with version
  std::string build;              ///< for the file's metadata
  bool packed{true};              ///< zstd
  bool ros2{false};               ///< poses and points also as ROS 2's messages
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< by pictures; may be empty
};

struct Exported {
  std::uint64_t pictures{0}, poses{0}, messages{0}, files{0};
  std::string last_link;  ///< of the hash chain
  std::string lacks;      ///< what of the scan's own file could not be read; empty: nothing
};

/// Everything that a replay needs, in the order of time; a picture comes once its pose has come.  Memory: the
/// tables, one picture, one chunk.  Written beside and renamed.
[[nodiscard]] Result<Exported> export_mcap(const ExportOptions& options);

}  // namespace biteline::recording
