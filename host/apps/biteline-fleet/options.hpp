// SPDX-License-Identifier: MIT
#pragma once
/// \file The command line of biteline-fleet.

#include <filesystem>
#include <optional>
#include <string>

#include "host/apps/biteline-fleet/recording_orders.hpp"
#include "host/apps/biteline-fleet/release_orders.hpp"
#include "host/fleet/broker_options.hpp"
#include "host/fleet/recording_limits.hpp"
#include "host/records/memory/factory_day.hpp"

namespace biteline::fleet {

inline constexpr const char* k_fleet_program = "biteline-fleet";

struct FleetOptions {
  BrokerOptions broker;
  std::string database;
  std::filesystem::path migrations;
  bool list{false};
  bool odd{false};
  std::string log_links;  ///< of this cell; empty: not asked
  ReleaseOrders releases;
  RecordingOrders fetches;
  std::filesystem::path recordings;
  RecordingLimits limits;
  std::string control;
  std::filesystem::path accounts;
  std::string time_zone;     ///< of the factory's day; empty: the machine's own
  memory::FactoryDay day{};  ///< when it begins
  std::optional<std::uint16_t> metrics;
  std::filesystem::path metrics_token;  ///< only this is done: a new one, into this file
  bool drop_metrics_token{false};       ///< only this is done
  bool json{false};
  bool exit_with_parent{false};

  /// The centre itself, and no word beside it.
  [[nodiscard]] bool runs() const {
    return !odd && !list && log_links.empty() && !releases.any() && !fetches.any();
  }
};

struct ParsedFleetOptions {
  FleetOptions options;
  std::optional<int> leave_with;
};

[[nodiscard]] ParsedFleetOptions parse_fleet_options(int argc, char** argv);

}  // namespace biteline::fleet
