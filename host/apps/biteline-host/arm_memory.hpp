// SPDX-License-Identifier: MIT
#pragma once
/// \file What the cell's arm gives, as earlier scans showed it: for those that do not.

#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/cloud/uncertainty/arm_sway.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::service {

/// What nine of ten of the last scans did not exceed that showed a level surface beside the shoe; none of
/// fewer than three.
[[nodiscard]] Result<std::optional<uncertainty::ArmGive>> remembered_arm(const memory::Memory& memory);

/// Keeps what scan `name` showed of its arm; nothing where its figure is not its own.
[[nodiscard]] Result<void> remember_arm(const std::string& name,
                                        const std::optional<uncertainty::ArmMotion>& arm,
                                        memory::Memory& memory);

}  // namespace biteline::service
