// SPDX-License-Identifier: MIT
#include "host/apps/biteline/cloud_option.hpp"

#include <map>

namespace biteline::app {

void add_reading_options(options::Command& command, cloud::Reading& reading) {
  std::map<std::string, cloud::Unit> units;
  for (const cloud::UnitRow& row : cloud::unit_rows()) units.emplace(row.name, row.unit);
  command
      .add_choice("--unit", reading.unit, units,
                  "The cloud's unit of length; as its head says, or mm, unless told")
      ->type_name("mm|cm|m|um|in");
  using enum cloud::Up;
  std::map<std::string, cloud::Up> axes;
  for (const cloud::Up up : {Z, MinusZ, Y, MinusY, X, MinusX}) axes.emplace(cloud::up_word(up), up);
  command.add_choice("--up", reading.up, axes, "The axis of the cloud that points up; the result has z up")
      ->type_name("z|-z|y|-y|x|-x");
}

Result<void> near_origin(const cloud::CloudFile& file, const std::filesystem::path& path) {
  if (file.origin.isZero()) return {};
  return fail(Errc::BadValue,
              "%s: a cloud within 10 m of its origin expected, found %.0f %.0f %.0f m: move it there",
              path.c_str(), file.origin.x() / 1000, file.origin.y() / 1000, file.origin.z() / 1000);
}

nlohmann::ordered_json as_json(const cloud::CloudFile& file, const cloud::Reading& reading) {
  nlohmann::ordered_json left_out = nlohmann::ordered_json::array();
  for (const cloud::LeftOut& some : file.left_out)
    left_out.push_back({{"why", some.why}, {"points", some.points}});
  return {{"understood", file.understood},
          {"unit", cloud::unit_row(file.unit.value_or(cloud::Unit::Millimetre)).name},
          {"up", cloud::up_word(reading.up)},
          {"size_mm", file.size_mm},
          {"origin_mm", {file.origin.x(), file.origin.y(), file.origin.z()}},
          {"left_out", left_out}};
}

}  // namespace biteline::app
