// SPDX-License-Identifier: MIT
#pragma once
/// \file The account of a scan for report.json: what came, what was used, what was lost and where.

#include <nlohmann/json.hpp>
#include <vector>

#include "common/wire/messages.hpp"
#include "host/intake/cloud_builder.hpp"

namespace biteline::intake {

[[nodiscard]] nlohmann::ordered_json account_of(const IngestCounts& counts, const wire::Counters& sensor,
                                                const std::vector<wire::StageTime>& sensor_stages);

/// Clocks with their uncertainty, trigger and links, as the sensor left them at the scan's end.
[[nodiscard]] nlohmann::ordered_json account_of(const wire::Devices& devices);

}  // namespace biteline::intake
