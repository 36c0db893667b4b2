// SPDX-License-Identifier: MIT
#pragma once
/// \file What of the fleet calls for a person now, under the bounds that Prometheus' rules have.

#include <span>
#include <string>
#include <vector>

#include "host/fleet/overview.hpp"

namespace biteline::fleet {

struct Alarm {
  std::string code;   ///< no_broker, cell_away, shoes_wait, many_refused, odd_cell
  std::string cell;   ///< empty: of the centre
  std::string model;  ///< of odd_cell
  double value{0};    ///< seconds not heard, shoes that wait, share refused, mm
};

/// The centre's first, then by cell.
[[nodiscard]] std::vector<Alarm> alarms_of(const FleetNews& news, std::span<const LastHour> hours,
                                           std::int64_t now_ms);

}  // namespace biteline::fleet
