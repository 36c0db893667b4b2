// SPDX-License-Identifier: MIT
#pragma once
/// \file How long the camera exposes, as the sensor tells it.

#include "common/wire/messages.hpp"

namespace biteline::gige {

/// Of a scan that begins: what its head was told; 0: not told.
[[nodiscard]] Nanoseconds exposure_of(const wire::SensorHello& hello);
/// What is in force now: as the automatic exposure has it, else as the camera took it; `otherwise` where
/// neither is told.  Of a bracket the first one.
[[nodiscard]] Nanoseconds exposure_of(const wire::Health& health, Nanoseconds otherwise);

}  // namespace biteline::gige
