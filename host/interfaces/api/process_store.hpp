// SPDX-License-Identifier: MIT
#pragma once
/// \file Processes by name: those that came with the program, and those saved at this cell.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/interfaces/control/messages.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::api {

struct StoredProcess {
  std::string name;
  std::filesystem::path file;
  bool shipped{false};
};

/// Thread: no state but the folders' names.  A saved one is written beside and renamed.
class ProcessStore {
 public:
  /// `shipped` may be empty or absent.
  ProcessStore(std::filesystem::path shipped, std::filesystem::path saved)
      : shipped_{std::move(shipped)}, saved_{std::move(saved)} {}

  /// By name; a saved one stands before a shipped one of its name.
  [[nodiscard]] std::vector<StoredProcess> list() const;
  [[nodiscard]] Result<StoredProcess> find(const std::string& name) const;
  /// As written in its file.
  [[nodiscard]] Result<control::Json> read(const std::string& name) const;
  /// As save() would take it, and not saved.  Errc::CheckFailed names key and range.
  [[nodiscard]] static Result<path::Process> check(const std::string& name, const control::Json& process);
  /// Checked as any process file; Errc::CheckFailed names key and range, and nothing is written.
  [[nodiscard]] Result<void> save(const std::string& name, const control::Json& process) const;

 private:
  std::filesystem::path shipped_, saved_;
};

}  // namespace biteline::api
