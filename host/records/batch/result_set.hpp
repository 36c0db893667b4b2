// SPDX-License-Identifier: MIT
#pragma once
/// \file All results of one run: the merged SQLite file, or a baseline pinned as text.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/records/batch/outcome.hpp"
#include "host/records/memory/database.hpp"

namespace biteline::batch {

inline constexpr const char* k_result_file = "batch.sqlite";

struct ResultRow {
  std::string name, kind, hash;
  Outcome outcome;
  std::optional<Cost> cost;  ///< none in a baseline, and where nothing ran
};

struct RunName {
  std::string build;
  std::string settings;
};

/// Thread: one owner.
class ResultSet {
 public:
  /// A folder with batch.sqlite, such a file, or a baseline (.json).
  [[nodiscard]] static Result<ResultSet> open(const std::filesystem::path& place);

  [[nodiscard]] const RunName& run() const { return run_; }
  [[nodiscard]] const std::vector<ResultRow>& rows() const { return rows_; }  ///< by name
  /// Of the row; empty without one.
  [[nodiscard]] Result<std::vector<LinePlace>> line(std::size_t row) const;
  /// False: a baseline, which holds some points of each line.
  [[nodiscard]] bool has_whole_lines() const { return database_ != nullptr; }

 private:
  friend Result<ResultSet> read_baseline(const std::filesystem::path& file);
  friend Result<ResultSet> read_results(const std::filesystem::path& file);
  RunName run_;
  std::vector<ResultRow> rows_;
  std::vector<std::vector<LinePlace>> lines_;  ///< of a baseline
  std::unique_ptr<memory::Database> database_;
};

/// Writes results one by one into a new file, which appears at the end.  Thread: one owner.
class ResultWriter {
 public:
  [[nodiscard]] static Result<ResultWriter> create(const std::filesystem::path& file, const RunName& run);
  [[nodiscard]] Result<void> add(const ResultRow& row, const std::vector<LinePlace>& line);
  /// Puts the file in its place.
  [[nodiscard]] Result<void> finish();

 private:
  ResultWriter(memory::Database database, std::filesystem::path file);
  std::unique_ptr<memory::Database> database_;
  std::filesystem::path file_;
};

/// The results as a text for version control: verdicts, figures, and at most 100 points of each line.
[[nodiscard]] Result<void> write_baseline(const std::filesystem::path& file, const ResultSet& results);

}  // namespace biteline::batch
