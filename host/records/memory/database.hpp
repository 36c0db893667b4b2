// SPDX-License-Identifier: MIT
#pragma once
/// \file SQLite as move-only owners that report errors by Result.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/core/result.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace biteline::memory {

/// A statement with its values bound; steps through its rows.  Columns and places count from 0.
/// Thread: one owner.
class Statement {
 public:
  Statement(Statement&&) noexcept = default;

  Statement& bind(std::string_view text);
  Statement& bind(std::int64_t number);
  Statement& bind(int number) { return bind(std::int64_t{number}); }
  Statement& bind(double number);
  Statement& bind(std::span<const std::uint8_t> bytes);
  Statement& bind_null();
  template <class Value>
  Statement& bind(const std::optional<Value>& value) {
    return value ? bind(*value) : bind_null();
  }

  /// True: there is a row to be read; false: the end.
  [[nodiscard]] Result<bool> step();
  /// To the end; rows are passed over.
  [[nodiscard]] Result<void> run();

  /// From the beginning again, with values to be bound anew.
  void again();

  [[nodiscard]] bool is_null(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double number(int column) const;
  [[nodiscard]] std::optional<double> number_if(int column) const;
  [[nodiscard]] std::span<const std::uint8_t> bytes(int column) const;  ///< until the next step

 private:
  friend class Database;
  struct Closer {
    void operator()(sqlite3_stmt* statement) const;
  };
  explicit Statement(sqlite3_stmt* statement) : statement_{statement} {}
  std::unique_ptr<sqlite3_stmt, Closer> statement_;
  int bound_{0};
  int worst_{0};  ///< of the binds; told by step()
};

/// One connection to one file, in WAL mode: readers and the one writer do not wait for each other; what was
/// committed survives the end of the process and of the power.  Thread: one owner.
class Database {
 public:
  enum class Access { ReadWrite, ReadOnly };
  /// ReadWrite makes the file, readable by its owner only.
  [[nodiscard]] static Result<Database> open(const std::filesystem::path& file, Access access);

  [[nodiscard]] Result<Statement> prepare(std::string_view sql);
  /// Several statements without values.
  [[nodiscard]] Result<void> execute(const std::string& sql);
  /// All of `work` or nothing of it.
  [[nodiscard]] Result<void> transaction(const std::function<Result<void>()>& work);

  [[nodiscard]] std::int64_t changes() const;
  [[nodiscard]] std::int64_t last_id() const;
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// A copy of this moment in a file of its own (SQLite's online backup).
  [[nodiscard]] Result<void> copy_to(const std::filesystem::path& target);

 private:
  struct Closer {
    void operator()(sqlite3* database) const;
  };
  Database(sqlite3* database, std::filesystem::path file) : database_{database}, file_{std::move(file)} {}
  std::unique_ptr<sqlite3, Closer> database_;
  std::filesystem::path file_;
};

}  // namespace biteline::memory
