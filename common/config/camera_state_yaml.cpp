// SPDX-License-Identifier: MIT
#include "common/config/camera_state_yaml.hpp"

#include <charconv>
#include <iterator>

#include "common/core/text.hpp"

namespace biteline::config {

geometry::CameraState read_camera_state(YamlReader& reader) {
  geometry::CameraState state;
  for (const geometry::StateRow& row : geometry::state_table()) {
    if (!reader.has(row.name)) {
      // Asked for all the same: a key without a value is a fault, and this one is known.
      static_cast<void>(reader.text_or(row.name, ""));
    } else if (row.is_switch) {
      state[row.key] = reader.boolean(row.name) ? 1 : 0;
    } else {
      state[row.key] = reader.number(row.name, row.range);
    }
  }
  constexpr std::size_t k_longest_word = 40;
  state.pixel_format = clean_text(reader.text_or("pixel_format", ""), k_longest_word);
  return state;
}

Result<geometry::CameraState> read_camera_state(const std::filesystem::path& file) {
  BITELINE_ASSIGN(YamlReader reader, YamlReader::open(file));
  geometry::CameraState state = read_camera_state(reader);
  BITELINE_TRY(reader.finish());
  return state;
}

std::string camera_state_text(const geometry::CameraState& state, const std::string& indent) {
  std::string text;
  for (const geometry::StateRow& row : geometry::state_table()) {
    const std::optional<double>& value = state[row.key];
    if (!value) continue;
    char digits[40];
    const std::string number{digits, std::to_chars(std::begin(digits), std::end(digits), *value).ptr};
    text += indent + row.name + ": " + (row.is_switch ? (*value != 0 ? "true" : "false") : number) + "\n";
  }
  if (!state.pixel_format.empty()) text += indent + "pixel_format: \"" + state.pixel_format + "\"\n";
  return text;
}

}  // namespace biteline::config
