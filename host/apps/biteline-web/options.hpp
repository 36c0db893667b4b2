// SPDX-License-Identifier: MIT
#pragma once
/// \file The command line of biteline-web.

#include <filesystem>
#include <optional>
#include <string>

#include "common/wire/endpoint.hpp"
#include "host/apps/biteline-web/add_user.hpp"
#include "host/apps/biteline-web/line/line_doors.hpp"
#include "host/apps/biteline-web/web_server.hpp"

namespace biteline::web {

struct WebOptions {
  WebConfig server;
  std::optional<wire::Endpoint> control;  ///< the service's end; none: only the sensor is shown
  std::optional<std::filesystem::path> control_keys;
  std::optional<wire::Endpoint> sensor;  ///< whose live data are shown; none: the one that the service names
  std::optional<std::filesystem::path> sensor_keys;
  LineDoorsConfig line;                    ///< no door of it is open unless asked for
  std::optional<AddUserRequest> add_user;  ///< only this is done
  std::filesystem::path accounts;          ///< of the next two: the file that the accounts are in
  std::filesystem::path metrics_token;     ///< only this is done: a new one, into this file
  bool drop_metrics_token{false};          ///< only this is done
  bool exit_with_parent{false};
};

struct ParsedWebOptions {
  WebOptions options;
  std::optional<int> leave_with;
};

[[nodiscard]] ParsedWebOptions parse_web_options(int argc, char** argv);

}  // namespace biteline::web
