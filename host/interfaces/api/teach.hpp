// SPDX-License-Identifier: MIT
#pragma once
/// \file What is taught, as an object of the service: every page sees who teaches what, and at which step.

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "host/interfaces/api/cell.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::api {

/// `Teaching` of the API.
[[nodiscard]] Json to_json(const memory::Teaching& teaching);

/// Writes the facts of the teaching that is open: of what doors say, and of what stands in the memory and in
/// the scan's folder.  What cannot be written is told all the same, and written later.
/// Thread: safe from any.  The cell is asked by nobody who holds the lock.
class TeachRoom {
 public:
  using Publish = std::function<void(const std::string&, Json)>;
  TeachRoom(memory::Memory& memory, Cell& cell, std::filesystem::path results, Publish publish)
      : memory_{memory}, cell_{cell}, results_{std::move(results)}, publish_{std::move(publish)} {}

  /// A start that holds was heard at `heard`: one that was open is replaced.
  void begin(const std::string& who, memory::UnixMs heard);
  /// A rescan that holds goes on with the one that is open, or begins one.
  void begin_or_go_on(const std::string& who, memory::UnixMs heard);
  /// The next scan is held no more; nothing where none is open.
  void give_up(const std::string& who);
  /// Somebody says that it is enough.  False: it is not the one that is open.
  [[nodiscard]] bool give_up(std::int64_t id, const std::string& who);
  /// What is new in memory and folder; the teaching that is open.
  [[nodiscard]] std::optional<memory::Teaching> look();
  /// As look(), with its number; one that has ended as it ended.
  [[nodiscard]] Result<std::optional<memory::Teaching>> look_at(std::int64_t id);

  void chose_process(const std::string& scan, const std::string& who);
  /// What stands in the scan's folder of an earlier run in the air: before() of it, until there is another.
  [[nodiscard]] std::string before_air(const std::string& scan) const;
  void runs_in_air(const std::string& scan, const std::string& who, const std::string& before);
  /// Somebody has looked at the dry run of what is there now.  Errc::WrongState: there is none, or it is not
  /// what is open.
  [[nodiscard]] Result<memory::Teaching> saw_dry_run(
      std::int64_t id, const memory::LogRow& event, const std::function<bool(const memory::TaughtWork&)>& is);
  /// Why a model of this scan with this process is not what was run in the air; empty: it is, or nobody
  /// teaches the scan.
  [[nodiscard]] Result<std::string> not_run(const std::string& scan, const std::string& process_sha256);
  void saved(const std::string& scan, const std::string& model, const std::string& who);

 private:
  [[nodiscard]] std::optional<memory::Teaching> open_locked();
  void begin_locked(const std::string& who, memory::UnixMs heard);
  /// `state`: of the cell.
  [[nodiscard]] memory::Teaching taken_in_locked(memory::Teaching teaching, const Json& state) const;
  [[nodiscard]] std::optional<memory::Teaching> look_locked(const Json& state);
  void put_locked(const memory::Teaching& teaching);
  void end_locked(memory::Teaching teaching, const char* how, const std::string& who);

  memory::Memory& memory_;
  Cell& cell_;
  std::filesystem::path results_;
  Publish publish_;
  std::mutex mutex_;
};

}  // namespace biteline::api
