// SPDX-License-Identifier: MIT
// YAML of a head and of a process: settings within their ranges, or one clean line.
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
  return 0;
}
