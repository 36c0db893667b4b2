// SPDX-License-Identifier: MIT
#pragma once
/// \file The tool of a path that is to be sent, brought by a changer.

#include <optional>
#include <string>

#include "host/apps/biteline-host/send_step.hpp"

namespace biteline::service {

struct BroughtTool {
  std::optional<std::string> stands{};  ///< its name; nothing: nobody knows
  std::string trouble{};                ///< why the wanted one does not stand; empty: it does
};

/// The changer turns only where no tool of it can reach shoe, fixture or table from where the arm stands.
/// Pre: request.mounted.changer; the arm is at rest.  Takes some seconds.
[[nodiscard]] BroughtTool bring_tool(const SendRequest& request, const path::Tool& tool,
                                     const path::Surroundings& surroundings, const SE3& T_base_flange);

/// Of the flange from shoe, fixture and table, mm.
[[nodiscard]] double room_at_flange_mm(const path::Surroundings& surroundings, const Vec3& flange_base);

}  // namespace biteline::service
