// SPDX-License-Identifier: MIT
#include "host/fleet/broker_options.hpp"

namespace biteline::fleet {

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
