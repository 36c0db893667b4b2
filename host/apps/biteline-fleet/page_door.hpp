// SPDX-License-Identifier: MIT
#pragma once
/// \file Where biteline-web comes in at the centre: accounts, and the answers to the page.

#include <memory>

#include "common/wire/endpoint.hpp"
#include "host/apps/biteline-fleet/page_api.hpp"
#include "host/interfaces/control/server.hpp"

namespace biteline::fleet {

struct PageDoorConfig {
  wire::Endpoint endpoint;         ///< on loopback: biteline-web runs beside
  std::filesystem::path accounts;  ///< folder of the accounts' file
  std::string database;
  std::filesystem::path migrations;
  std::string version;
  memory::FactoryDay day{};
};

/// Thread: the answers have those of control::Server, beside the centre's work.
class PageDoor {
 public:
  [[nodiscard]] static Result<std::unique_ptr<PageDoor>> open(const PageDoorConfig& config);
  [[nodiscard]] const std::string& address() const { return server_->address(); }
  void show_broker(bool up) { broker_ = up; }

 private:
  explicit PageDoor(memory::Memory memory) : memory_{std::move(memory)}, accounts_{memory_} {}

  memory::Memory memory_;
  accounts::Accounts accounts_;
  std::atomic<bool> broker_{false};
  std::unique_ptr<PageApi> api_;
  std::unique_ptr<control::Server> server_;  ///< last: its threads use the rest
};

}  // namespace biteline::fleet
