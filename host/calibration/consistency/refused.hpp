// SPDX-License-Identifier: MIT
#pragma once
/// \file Why a scan's points are not believed.

#include "host/report/refusal.hpp"

namespace biteline::consistency {

enum class Refused {
  NotAsCalibrated,  ///< the pictures came otherwise than the head was calibrated
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

}  // namespace biteline::consistency
