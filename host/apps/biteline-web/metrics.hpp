// SPDX-License-Identifier: MIT
#pragma once
/// \file /metrics: the cell in Prometheus' text form (exposition format 0.0.4).

#include <cstdint>
#include <string>

#include "host/interfaces/control/messages.hpp"

namespace biteline::web {

struct ServerCounts {
  std::uint64_t requests{0};
  std::uint64_t refused{0};  ///< answered 4xx by this program, among them those that were no HTTP
  std::uint64_t forwarded{0};
  std::uint64_t host_away{0};  ///< answered 503 for want of a service
  int connections{0};
  int watchers{0};
  int listeners{0};
  std::uint64_t pictures{0};
  std::uint64_t profiles{0};
};

/// `state` and `sensors` are the bodies of /api/v1/state and /api/v1/sensors; what is missing in them is left
/// out.
[[nodiscard]] std::string metrics_text(const ServerCounts& counts, const control::Json& state,
                                       const control::Json& sensors);

}  // namespace biteline::web
