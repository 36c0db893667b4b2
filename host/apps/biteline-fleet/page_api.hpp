// SPDX-License-Identifier: MIT
#pragma once
/// \file The meaning of /api/v1 at the centre (host/web/openapi.yaml).  Nothing here reaches an arm.

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/fleet/centre.hpp"
#include "host/interfaces/accounts/accounts.hpp"
#include "host/interfaces/api/routes.hpp"
#include "host/interfaces/control/messages.hpp"
#include "host/records/memory/factory_day.hpp"

namespace biteline::fleet {

struct PageRooms {
  std::string database;  ///< of libpq
  std::filesystem::path migrations;
  memory::Memory& memory;  ///< of accounts and log; the shoes are in the database
  accounts::Accounts& accounts;
  const std::atomic<bool>& broker;  ///< there is a line
  std::string version;
  memory::FactoryDay day{};  ///< of filters and trends
};

/// Has a line to the database of its own.  Thread: one at a time.
class PageApi {
 public:
  explicit PageApi(PageRooms rooms) : rooms_{std::move(rooms)} {}
  [[nodiscard]] control::Answer answer(const control::Request& request);

 private:
  struct Call {
    const control::Request& request;
    accounts::Person person;
    std::vector<std::string> names;  ///< what stands in the path's braces, in order
  };
  struct Row;
  [[nodiscard]] static std::span<const Row> rows();
  [[nodiscard]] control::Answer dispatch(const control::Request& request);
  /// The last good answer to the same question, while it is fresh: many pages cost as much as one.
  [[nodiscard]] control::Answer kept_or(const Call& call, control::Answer (PageApi::*asked)(const Call&));
  /// Errc::ConnectionLost or ConnectFailed: the database is away.
  [[nodiscard]] Result<Centre*> centre();
  [[nodiscard]] control::Answer answer_of(const Error& error);

  // `Answer operationId(const Call&)` for each operation that the API's documents give to the centre.
#include "host/interfaces/api/centre_handlers.inc"

  void log(const Call& call, const char* action, const std::string& subject) const;

  struct Kept {
    std::chrono::steady_clock::time_point until;
    control::Answer answer;
  };

  PageRooms rooms_;
  std::optional<Centre> centre_;
  std::map<std::string, Kept> kept_;  ///< by path and query
};

}  // namespace biteline::fleet
