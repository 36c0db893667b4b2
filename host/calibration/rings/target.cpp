// SPDX-License-Identifier: MIT
#include "host/calibration/rings/target.hpp"

#include "common/config/yaml_reader.hpp"

namespace biteline::calibration {
namespace {

// Wide on purpose: metres given for millimetres are found out by the motions, which can say so.
constexpr config::YamlReader::Range k_lengths_mm{.minimum = 1e-4, .maximum = 1e5};

void read_rings(config::YamlReader& reader, RingTarget& target) {
  target.rows = static_cast<int>(reader.integer("rows", {.minimum = 2, .maximum = 100}));
  target.cols = static_cast<int>(reader.integer("cols", {.minimum = 2, .maximum = 100}));
  target.pitch_mm = reader.number("pitch", k_lengths_mm);
  target.outer_diameter_mm = reader.number("outer_diameter", k_lengths_mm);
  target.inner_diameter_mm = reader.number("inner_diameter", k_lengths_mm);
  if (target.outer_diameter_mm >= target.pitch_mm) {
    reader.fault(Errc::BadValue, "outer_diameter", "less than the pitch: rings must not touch");
  }
  if (target.inner_diameter_mm >= target.outer_diameter_mm) {
    reader.fault(Errc::BadValue, "inner_diameter", "less than outer_diameter");
  }
}

/// Squares are counted, as a person counts them; one less of each are the corners inside.
void read_chessboard(config::YamlReader& reader, RingTarget& target) {
  target.rows = static_cast<int>(reader.integer("square_rows", {.minimum = 3, .maximum = 101})) - 1;
  target.cols = static_cast<int>(reader.integer("square_cols", {.minimum = 3, .maximum = 101})) - 1;
  target.pitch_mm = reader.number("pitch", k_lengths_mm);
  target.first_is_white = reader.choice_or_first("first_square", {"black", "white"}) == "white";
}

}  // namespace

Result<RingTarget> read_target(const std::filesystem::path& file) {
  BITELINE_ASSIGN(auto reader, config::YamlReader::open(file));
  RingTarget target;
  if (reader.choice_or_first("kind", {"rings", "chessboard"}) == "chessboard") {
    target.kind = TargetKind::Chessboard;
    read_chessboard(reader, target);
  } else {
    read_rings(reader, target);
  }
  target.planes = static_cast<int>(reader.integer_or("planes", 1, {.minimum = 1, .maximum = 2}));
  BITELINE_TRY(reader.finish());
  return target;
}

}  // namespace biteline::calibration
