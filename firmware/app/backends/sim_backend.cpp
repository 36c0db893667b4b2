// SPDX-License-Identifier: MIT
// The simulated cell's wires as a board's: "sim:NAME" in place of a chip or an interface.
#include <algorithm>
#include <array>
#include <utility>

#include "firmware/app/backends/backend.hpp"
#include "hal/sim/bus/bus_devices.hpp"

namespace biteline::sensor {
namespace {

constexpr std::array<std::pair<std::string_view, sim::Line>, 7> k_lines{
    {{"laser-enable", sim::Line::LaserEnable},
     {"strobe-echo", sim::Line::StrobeEcho},
     {"scan-active", sim::Line::ScanActive},
     {"interlock", sim::Line::Interlock},
     {"key", sim::Line::Key},
     {"too-hot", sim::Line::TooHot},
     {"heartbeat", sim::Line::Heartbeat}}};

std::string wires_of(const std::string& address) {
  return address.substr(hal::k_simulated_wires.size());
}

Result<sim::Line> line_of(const hal::GpioLineAddress& address) {
  const auto found = std::ranges::find(k_lines, std::string_view{address.line},
                                       &std::pair<std::string_view, sim::Line>::first);
  if (found != k_lines.end()) return found->second;
  return fail(Errc::DeviceNotFound,
              "simulated line %.60s: one of laser-enable, strobe-echo, scan-active, interlock, key, too-hot, "
              "heartbeat expected",
              address.line.c_str());
}

Result<std::unique_ptr<hal::GpioOut>> output(const hal::GpioLineAddress& address) {
  BITELINE_ASSIGN(const sim::Line line, line_of(address));
  return sim::SimGpioOut::open(wires_of(address.chip), line);
}

Result<std::unique_ptr<hal::EdgeIn>> edges(const hal::GpioLineAddress& address) {
  BITELINE_ASSIGN(const sim::Line line, line_of(address));
  return sim::SimEdgeIn::open(wires_of(address.chip), line);
}

/// Interlock, key and the head's thermal contact: all three of the cell's, whatever the board's file names.
Result<std::unique_ptr<hal::SafetyIn>> safety(const hal::BoardLaser& laser) {
  return sim::SimSafetyIn::open(wires_of(laser.interlock.chip));
}

Result<std::unique_ptr<hal::PwmOut>> timer(const hal::BoardTrigger& trigger) {
  return sim::SimPwmOut::open(wires_of(trigger.chip));
}

Result<std::unique_ptr<hal::CanBus>> can_bus(const std::string& interface) {
  return sim::SimCanBus::open(wires_of(interface));
}

}  // namespace

extern const Backend k_sim_backend;
const Backend k_sim_backend{
    .name = "sim", .output = output, .edges = edges, .safety = safety, .timer = timer, .can_bus = can_bus};

}  // namespace biteline::sensor
