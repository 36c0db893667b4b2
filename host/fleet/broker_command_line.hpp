// SPDX-License-Identifier: MIT
#pragma once
/// \file The broker's options on the command lines of both ends.

#include "common/options/command.hpp"
#include "host/fleet/broker_options.hpp"

namespace biteline::fleet {

inline void add_broker_options(options::Command& app, BrokerOptions& options) {
  app.add_option("--broker", options.address,
                 "The MQTT broker: mqtts://HOST:PORT; without TLS (mqtt://) on loopback only");
  app.add_option("--ca", options.tls.authority, "PEM of the authority that signed the broker's certificate");
  app.add_option("--certificate", options.tls.certificate, "This end's PEM certificate");
  app.add_option("--key", options.tls.key, "The certificate's PEM key");
}

}  // namespace biteline::fleet
