// SPDX-License-Identifier: MIT
#pragma once
/// \file Results by key, shared by all processes and machines that see the folder.

#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/records/batch/outcome.hpp"

namespace biteline::batch {

/// What a result is filed under: the recording, the build and the settings.
[[nodiscard]] std::string result_key(const std::string& recording_hash, const std::string& build,
                                     const std::string& settings);

/// `folder`/ab/<key>/ holds result.json, line.csv where there is one, cost.json.  A result appears whole or
/// not at all; of two that come for one key the first stays.
class ResultStore {
 public:
  explicit ResultStore(std::filesystem::path folder) : folder_{std::move(folder)} {}

  /// None: nothing there, or nothing that can be read.
  [[nodiscard]] std::optional<Outcome> find(const std::string& key) const;
  /// `line_csv`: the text of the line; empty without one.
  [[nodiscard]] Result<void> put(const std::string& key, const Outcome& outcome, const std::string& line_csv,
                                 const Cost& cost) const;
  [[nodiscard]] Result<void> forget(const std::string& key) const;

  [[nodiscard]] std::filesystem::path line_file(const std::string& key) const;
  [[nodiscard]] Result<Cost> cost(const std::string& key) const;

 private:
  [[nodiscard]] std::filesystem::path place(const std::string& key) const;
  std::filesystem::path folder_;
};

}  // namespace biteline::batch
