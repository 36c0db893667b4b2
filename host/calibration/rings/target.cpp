// SPDX-License-Identifier: MIT
#include "host/calibration/rings/target.hpp"

#include "common/config/yaml_reader.hpp"

namespace biteline::calibration {

Result<RingTarget> read_target(const std::filesystem::path& file) {
  BITELINE_ASSIGN(auto reader, config::YamlReader::open(file));
  RingTarget target;
  target.rows = static_cast<int>(reader.integer("rows", {.minimum = 2, .maximum = 100}));
  target.cols = static_cast<int>(reader.integer("cols", {.minimum = 2, .maximum = 100}));
  // Wide on purpose: metres given for millimetres are found out by the motions, which can say so.
  target.pitch_mm = reader.number("pitch", {.minimum = 1e-4, .maximum = 1e5});
  target.outer_diameter_mm = reader.number("outer_diameter", {.minimum = 1e-4, .maximum = 1e5});
  target.inner_diameter_mm = reader.number("inner_diameter", {.minimum = 1e-4, .maximum = 1e5});
  target.planes = static_cast<int>(reader.integer_or("planes", 1, {.minimum = 1, .maximum = 2}));
  if (target.outer_diameter_mm >= target.pitch_mm) {
    reader.fault(Errc::BadValue, "outer_diameter", "less than the pitch: rings must not touch");
  }
  if (target.inner_diameter_mm >= target.outer_diameter_mm) {
    reader.fault(Errc::BadValue, "inner_diameter", "less than outer_diameter");
  }
  BITELINE_TRY(reader.finish());
  return target;
}

}  // namespace biteline::calibration
