// SPDX-License-Identifier: MIT
#pragma once
/// \file The centre's database (PostgreSQL): every shoe of every cell, once and in order.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/fleet/messages.hpp"
#include "host/fleet/odd_cell.hpp"

namespace biteline::fleet {

/// A cell as the centre knows it.
struct CellRow {
  std::string cell, version;
  bool online{false};
  std::int64_t heard_ms{0};  ///< since 1970, UTC
  std::int64_t waiting{0};
  std::int64_t shoes{0}, ok{0}, amber{0}, review{0}, refused{0}, failed{0};
  std::optional<std::int64_t> last_shoe_ms{};
};

struct FromCell {
  std::string cell;
  ShoeMessage shoe;
};
/// A link of a cell's log, and when the cell told it.
struct ToldLink {
  memory::LogLink link;
  std::string book;  ///< of the cell's memory
  std::int64_t told_ms{0};
};
struct CommittedOf {
  std::string cell;
  CommittedMessage to;
};

/// Thread: one owner.
class Centre {
 public:
  /// `database`: of libpq ("host=... dbname=..."); brings the tables up to the newest of `migrations`
  /// (NNNN_*.sql). Errc::ConnectFailed: nobody answers; Errc::NotSupported: the tables are of a newer
  /// program.
  [[nodiscard]] static Result<Centre> open(const std::string& database,
                                           const std::filesystem::path& migrations);
  Centre(Centre&&) noexcept;
  Centre& operator=(Centre&&) noexcept;
  ~Centre();

  /// All or nothing, in one transaction.  A shoe whose row before is not the last one of its cell is passed
  /// over: it was committed already, or one before it is missing.  One with a fault is taken without what was
  /// wrong, as a dead letter.  Returns where each cell that was named stands.
  [[nodiscard]] Result<std::vector<CommittedOf>> commit(const std::vector<FromCell>& shoes);
  [[nodiscard]] Result<CommittedMessage> committed(const std::string& cell, const std::string& book);
  [[nodiscard]] Result<void> note_health(const std::string& cell, const HealthMessage& health);
  [[nodiscard]] Result<std::vector<CellRow>> cells();
  /// What a cell's log is compared with, oldest first; the newest 50 000.
  [[nodiscard]] Result<std::vector<ToldLink>> log_links(const std::string& cell);
  /// Models with distances, by name.
  [[nodiscard]] Result<std::vector<std::string>> models();
  /// The newest `most` shoes of each cell that have distances to this model's line, each cell's oldest first.
  [[nodiscard]] Result<std::vector<PlacedShoe>> placed_shoes(const std::string& model, int most);

 private:
  friend class Overview;
  friend class Recordings;
  friend class Releases;
  struct State;
  explicit Centre(std::unique_ptr<State> state);
  template <class Value>
  Result<Value> work(const std::function<Result<Value>(State&)>& on);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::fleet
