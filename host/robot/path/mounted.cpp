// SPDX-License-Identifier: MIT
#include "host/robot/path/mounted.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/fixed_text.hpp"

namespace biteline::path {

std::optional<double> tip_off_mm(const Process& process, const Mounted& mounted) {
  if (!mounted.tip_flange) return std::nullopt;
  return (process.tool.T_flange_tcp.translation() - *mounted.tip_flange).norm();
}

std::optional<bool> carries_as_taught(const Process& process, const Mounted& mounted) {
  if (!mounted.payload || !process.tool.payload) return std::nullopt;
  return std::abs(process.tool.payload->mass_kg - mounted.payload->mass_kg) <= k_taught_payload_kg &&
         (process.tool.payload->centre_flange_mm - mounted.payload->centre_flange_mm).norm() <=
             k_taught_centre_mm;
}

std::optional<bool> has_its_tool(const Process& process, const Mounted& mounted) {
  if (process.tool.name.empty()) return std::nullopt;
  return mounted.tool == process.tool.name;
}

bool waits_for_its_tool(const Process& process, const Mounted& mounted) {
  return has_its_tool(process, mounted) == false && !mounted.changer;
}

bool asks_a_changer(const Process& process, const Mounted& mounted) {
  if (!mounted.changer || process.digital_output < 0) return false;
  const auto asks = [&](const ChangerLines& place) { return place.ask_output == process.digital_output; };
  return asks(mounted.changer->wanted) || std::ranges::any_of(mounted.changer->others, asks);
}

std::optional<bool> switches_as_taught(const Process& process, const Mounted& mounted) {
  if (asks_a_changer(process, mounted)) return false;
  if (!mounted.lines || !mounted.lines->on_output) return std::nullopt;
  return process.digital_output == *mounted.lines->on_output;
}

std::optional<Payload> carried(const Process& process, const Mounted& mounted) {
  return process.tool.payload ? process.tool.payload : mounted.payload;
}

std::vector<Check> check_mounted(const Process& process, const Mounted& mounted) {
  std::vector<Check> checks;
  if (const std::optional<double> off_mm = tip_off_mm(process, mounted)) {
    const Vec3& tip = *mounted.tip_flange;
    checks.push_back({.name = "tip as taught",
                      .passed = *off_mm <= k_taught_tip_mm,
                      .value = *off_mm,
                      .limit = k_taught_tip_mm,
                      .unit = "mm",
                      .arc_mm = -1,
                      .detail = {}});
    if (!checks.back().passed) {
      const Vec3 own = process.tool.T_flange_tcp.translation();
      checks.back().detail = FixedText<200>::format(
                                 "the process's tip stands at (%.1f, %.1f, %.1f) mm in the flange, the one "
                                 "taught at (%.1f, %.1f, %.1f)",
                                 own.x(), own.y(), own.z(), tip.x(), tip.y(), tip.z())
                                 .view();
    }
  }
  if (const std::optional<bool> same = carries_as_taught(process, mounted)) {
    const double off_kg = std::abs(process.tool.payload->mass_kg - mounted.payload->mass_kg);
    const double off_mm = (process.tool.payload->centre_flange_mm - mounted.payload->centre_flange_mm).norm();
    const bool by_mass = off_kg > k_taught_payload_kg || *same;
    checks.push_back({.name = "payload as taught",
                      .passed = *same,
                      .value = by_mass ? off_kg : off_mm,
                      .limit = by_mass ? k_taught_payload_kg : k_taught_centre_mm,
                      .unit = by_mass ? "kg" : "mm",
                      .arc_mm = -1,
                      .detail = {}});
    if (!*same) {
      checks.back().detail = FixedText<160>::format("the process carries %.2f kg, %.2f kg were taught%s",
                                                    process.tool.payload->mass_kg, mounted.payload->mass_kg,
                                                    by_mass ? "" : ", with another centre")
                                 .view();
    }
  }
  if (const std::optional<bool> same = switches_as_taught(process, mounted)) {
    const int taught = mounted.lines ? mounted.lines->on_output.value_or(-1) : -1;
    checks.push_back({.name = "output as taught",
                      .passed = *same,
                      .value = static_cast<double>(process.digital_output),
                      .limit = static_cast<double>(taught),
                      .unit = "",
                      .arc_mm = -1,
                      .detail = {}});
    if (!*same)
      checks.back().detail =
          asks_a_changer(process, mounted)
              ? FixedText<160>::format("the process switches output %d, which asks the changer for a tool",
                                       process.digital_output)
                    .view()
          : process.digital_output < 0
              ? FixedText<160>::format("the process switches no output, its tool was taught with %d", taught)
                    .view()
              : FixedText<160>::format("the process switches output %d, its tool was taught with %d",
                                       process.digital_output, taught)
                    .view();
  }
  return checks;
}

}  // namespace biteline::path
