// SPDX-License-Identifier: MIT
#pragma once
/// \file What a unit has been through, as the API tells it.

#include "common/wire/messages.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::control {

/// `Upkeep` of the API; temperatures are null where no camera has told any.
[[nodiscard]] Json to_json(const wire::UpkeepState& upkeep);

}  // namespace biteline::control
