// SPDX-License-Identifier: MIT
#pragma once
/// \file The meaning of /api/v1 at the centre (host/web/openapi_fleet.yaml).  Nothing here reaches an arm.

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/doors/accounts/accounts.hpp"
#include "host/doors/control/messages.hpp"
#include "host/fleet/centre.hpp"
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
    std::string name;  ///< of a user in the path
  };
  struct Route;
  [[nodiscard]] static std::vector<Route> routes();
  [[nodiscard]] control::Answer dispatch(const control::Request& request);
  /// The last good answer to the same question, while it is fresh: many pages cost as much as one.
  [[nodiscard]] control::Answer kept_or(const Call& call, control::Answer (PageApi::*asked)(const Call&));
  /// Errc::ConnectionLost or ConnectFailed: the database is away.
  [[nodiscard]] Result<Centre*> centre();
  [[nodiscard]] control::Answer answer_of(const Error& error);

  [[nodiscard]] control::Answer read_state(const Call& call);
  [[nodiscard]] control::Answer read_for_metrics(const Call& call);
  [[nodiscard]] control::Answer read_log(const Call& call);
  [[nodiscard]] control::Answer list_cells(const Call& call);
  [[nodiscard]] control::Answer list_shoes(const Call& call);
  [[nodiscard]] control::Answer read_trends(const Call& call);
  [[nodiscard]] control::Answer list_groups(const Call& call);
  [[nodiscard]] control::Answer list_alarms(const Call& call);
  [[nodiscard]] control::Answer list_odd(const Call& call);
  [[nodiscard]] control::Answer list_releases(const Call& call);
  [[nodiscard]] control::Answer list_fetches(const Call& call);
  [[nodiscard]] control::Answer fetch(const Call& call);
  [[nodiscard]] control::Answer mark(const Call& call);
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
