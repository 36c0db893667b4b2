// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"
#include "hal/linux/gpiod/gpiod_edge_in.hpp"
#include "hal/linux/gpiod/gpiod_out.hpp"
#include "hal/linux/gpiod/gpiod_safety_in.hpp"
#include "hal/linux/thermal/thermal_safety_in.hpp"

namespace biteline::sensor {
namespace {

Result<std::unique_ptr<hal::GpioOut>> output(const hal::GpioLineAddress& line) {
  return hal::GpiodOut::open(line);
}

Result<std::unique_ptr<hal::EdgeIn>> edges(const hal::GpioLineAddress& line) {
  return hal::GpiodEdgeIn::open(line);
}

Result<std::unique_ptr<hal::SafetyIn>> safety(const hal::BoardLaser& laser) {
  BITELINE_ASSIGN(std::unique_ptr<hal::SafetyIn> lines,
                  hal::GpiodSafetyIn::open({.interlock = laser.interlock, .key = laser.key}));
  if (laser.temperature.empty()) return lines;
  return hal::ThermalSafetyIn::open(std::move(lines),
                                    {.file = laser.temperature, .max_degc = laser.temperature_max_degc});
}

}  // namespace

extern const Backend k_gpio_backend;
const Backend k_gpio_backend{.name = "gpio", .output = output, .edges = edges, .safety = safety};

}  // namespace biteline::sensor
