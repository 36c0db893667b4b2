// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/tool_step.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/fixed_text.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/robot/link/ur/tool_changer.hpp"

namespace biteline::service {
namespace {

std::string in_the_way(const SendRequest& request, const path::Tool& tool,
                       const path::Surroundings& surroundings, const SE3& T_base_flange) {
  const double room_mm = room_at_flange_mm(surroundings, T_base_flange.translation());
  const double needed_mm = robot::ur::room_to_change_mm(*request.mounted.changer, tool);
  if (room_mm >= needed_mm) return {};
  return FixedText<200>::format(
             "the tools have no room to turn: shoe or table is %.0f mm from the flange, %.0f mm are needed; "
             "drive the arm away",
             room_mm, needed_mm)
      .c_str();
}

}  // namespace

double room_at_flange_mm(const path::Surroundings& surroundings, const Vec3& flange_base) {
  double room_mm = flange_base.z() - surroundings.table_z_mm;
  for (const Vec3& point : surroundings.shoe_points)
    room_mm = std::min(room_mm, (point - flange_base).norm() - surroundings.shoe_spacing_mm / 2);
  return room_mm;
}

BroughtTool bring_tool(const SendRequest& request, const path::Tool& tool,
                       const path::Surroundings& surroundings, const SE3& T_base_flange) {
  const std::string blocked = in_the_way(request, tool, surroundings, T_base_flange);
  const Result<void> done = [&]() -> Result<void> {
    BITELINE_ASSIGN(const HostPort rtde, parse_host_port(request.controller.rtde));
    return robot::ur::change_tool({.host = rtde.host, .rtde_port = rtde.port}, *request.mounted.changer,
                                  blocked, request.mark);
  }();
  if (done) return {.stands = tool.name};
  warn_step("the changer has not brought %s: %s", tool.name.c_str(), to_line(done.error()).c_str());
  BroughtTool none{.trouble = std::string{done.error().where.view()}};
  const bool asked = done.error().code != Errc::ConnectFailed && done.error().code != Errc::CheckFailed;
  if (!asked && request.mounted.tool != tool.name) none.stands = request.mounted.tool;
  return none;
}

}  // namespace biteline::service
