// SPDX-License-Identifier: MIT
#pragma once
/// \file How both ends are told of the broker.

#include <string>

#include "host/fleet/broker.hpp"

namespace biteline::fleet {

struct BrokerOptions {
  std::string address;
  TlsFiles tls;
};

/// Errc::InvalidArgument says which option is missing.
[[nodiscard]] Result<BrokerConfig> broker_of(const BrokerOptions& options);

}  // namespace biteline::fleet
