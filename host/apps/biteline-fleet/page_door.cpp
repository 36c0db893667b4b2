// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/page_door.hpp"

#include "host/apps/biteline-fleet/metrics_door.hpp"
#include "host/interfaces/accounts/first_token.hpp"
#include "host/report/report.hpp"

namespace biteline::fleet {

Result<std::unique_ptr<PageDoor>> PageDoor::open(const PageDoorConfig& config) {
  if (!config.endpoint.loopback())
    return fail(Errc::InvalidArgument, "--control %.100s: on loopback only; biteline-web runs beside",
                config.endpoint.host.c_str());
  BITELINE_TRY(report::prepare_folder(config.accounts));
  BITELINE_ASSIGN(memory::Memory memory, memory::Memory::open(config.accounts / k_accounts_file));
  std::unique_ptr<PageDoor> door{new PageDoor{std::move(memory)}};
  BITELINE_TRY(accounts::offer_first_account(door->accounts_, config.accounts));
  door->api_ = std::make_unique<PageApi>(PageRooms{.database = config.database,
                                                   .migrations = config.migrations,
                                                   .memory = door->memory_,
                                                   .accounts = door->accounts_,
                                                   .broker = door->broker_,
                                                   .version = config.version,
                                                   .day = config.day});
  control::ServerConfig server;
  server.endpoint = config.endpoint;
  std::error_code error;
  server.hello = {{"version", config.version},
                  {"accounts", std::filesystem::absolute(config.accounts, error).string()},
                  {"started", control::utc_now()}};
  PageApi* const api = door->api_.get();
  BITELINE_ASSIGN(
      door->server_,
      control::Server::open(
          server, {.urgent = [](const control::Request&) { return std::optional<control::Answer>{}; },
                   .ordinary = [api](const control::Request& request) { return api->answer(request); }}));
  return door;
}

}  // namespace biteline::fleet
