// SPDX-License-Identifier: MIT
#pragma once
/// \file The broker's options on the command lines of both ends.

#include <string>

#include "host/fleet/broker.hpp"

namespace CLI {
class App;
}

namespace biteline::fleet {

struct BrokerOptions {
  std::string address;
  TlsFiles tls;
};

void add_broker_options(CLI::App& app, BrokerOptions& options);
/// Errc::InvalidArgument says which option is missing.
[[nodiscard]] Result<BrokerConfig> broker_of(const BrokerOptions& options);

}  // namespace biteline::fleet
