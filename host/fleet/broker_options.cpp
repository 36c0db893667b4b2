// SPDX-License-Identifier: MIT
#include "host/fleet/broker_options.hpp"

#include <CLI/CLI.hpp>

namespace biteline::fleet {

void add_broker_options(CLI::App& app, BrokerOptions& options) {
  app.add_option("--broker", options.address,
                 "The MQTT broker: mqtts://HOST:PORT; without TLS (mqtt://) on loopback only");
  app.add_option("--ca", options.tls.authority, "PEM of the authority that signed the broker's certificate");
  app.add_option("--certificate", options.tls.certificate, "This end's PEM certificate");
  app.add_option("--key", options.tls.key, "The certificate's PEM key");
}

Result<BrokerConfig> broker_of(const BrokerOptions& options) {
  if (options.address.empty()) return fail(Errc::InvalidArgument, "--broker mqtts://HOST:PORT expected");
  BITELINE_ASSIGN(BrokerConfig config, parse_broker(options.address));
  if (!config.tls) return config;
  const TlsFiles& tls = options.tls;
  if (tls.authority.empty() || tls.certificate.empty() || tls.key.empty())
    return fail(Errc::InvalidArgument, "mqtts:// needs --ca, --certificate and --key");
  config.tls = tls;
  return config;
}

}  // namespace biteline::fleet
