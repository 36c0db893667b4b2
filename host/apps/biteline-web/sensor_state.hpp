// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor's own state for its page: settings in use, laser, trigger, temperature, counts.

#include <string>

#include "common/wire/messages.hpp"

namespace biteline::web {

/// JSON as openapi.yaml's /live describes it.  Settings that cannot be read are left out.
[[nodiscard]] std::string sensor_state(const wire::SensorHello& sensor, const wire::Health& health);

}  // namespace biteline::web
