// SPDX-License-Identifier: MIT
// YAML of a head, of a process and of a set of settings: values within their ranges, or one clean line.
#include "common/settings/settings.hpp"
#include "common/config/sensor_yaml.hpp"
#include "common/core/numbers.hpp"
#include "host/robot/path/process.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file{data, size};
  if (const auto sensor = config::read_sensor_yaml(file.path())) {
    fuzz::demand(sensor->region.width_px > 0 && sensor->region.height_px > 0, "a region has pixels");
    fuzz::demand(is_plausible_place(Vec3{sensor->T_flange_cam.translation()}), "a head is near its flange");
  } else {
    fuzz::demand_clean(sensor.error());
  }
  if (const auto process = path::read_process(file.path())) {
    fuzz::demand(process->motion.speed_mm_s >= 0.1 && process->motion.speed_mm_s <= 1000,
                 "a speed is in its range");
  } else {
    fuzz::demand_clean(process.error());
  }
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (const auto set = settings::parse_settings(text, "set.yaml")) {
    const auto again = settings::parse_settings(settings::settings_text(*set), "again.yaml");
    fuzz::demand(again.has_value() && settings::compare(*set, *again).empty(),
                 "a set that was read can be kept");
  } else {
    fuzz::demand_clean(set.error());
  }
  return 0;
}
