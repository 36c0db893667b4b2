// SPDX-License-Identifier: MIT
#include "common/session/recording_facts.hpp"

#include <algorithm>
#include <cstdio>

#include "common/config/yaml_reader.hpp"

namespace biteline::session {
namespace {

constexpr double k_most = 1e15;
constexpr double k_most_every = 1e6;

std::uint64_t count_of(config::YamlReader& reader, const char* key) {
  return static_cast<std::uint64_t>(reader.number(key, {.minimum = 0, .maximum = k_most}));
}

/// In double quotes; what would end them or the line is left out.
std::string quoted(std::string text) {
  std::erase_if(text, [](unsigned char c) { return c < 0x20 || c == '"' || c == '\\' || c == 0x7F; });
  return '"' + text + '"';
}

const char* word(bool value) {
  return value ? "true" : "false";
}

}  // namespace

Result<RecordingFacts> read_recording_facts(const std::filesystem::path& file) {
  BITELINE_ASSIGN(config::YamlReader reader, config::YamlReader::open(file));
  RecordingFacts facts;
  facts.sensor = reader.text_or("sensor", "");
  facts.version = reader.text_or("version", "");
  {
    config::YamlReader peaks = reader.child("peaks", true);
    facts.peak_mode = peaks.text("mode");
    facts.peak_choice = peaks.text("choice");
    facts.peak_threshold_grey = peaks.number("threshold_grey", {.minimum = 1, .maximum = 254});
    facts.peak_width_min_px = peaks.number("width_min_px", {.minimum = 0.1, .maximum = 1000});
    facts.peak_width_max_px = peaks.number("width_max_px", {.minimum = 0.1, .maximum = 1000});
  }
  facts.second_exposures = reader.boolean("second_exposures");
  facts.laser_off_frames = reader.boolean("laser_off_frames");
  facts.complete = reader.boolean("complete");
  facts.pictures_every = static_cast<std::uint32_t>(
      reader.number_or("pictures_every", 1, {.minimum = 0, .maximum = k_most_every}));
  facts.pictures = count_of(reader, "pictures");
  facts.pictures_left_out = count_of(reader, "pictures_left_out");
  facts.poses = count_of(reader, "poses");
  facts.poses_left_out = count_of(reader, "poses_left_out");
  facts.messages = count_of(reader, "messages");
  facts.messages_left_out = count_of(reader, "messages_left_out");
  facts.unrepeatable = count_of(reader, "unrepeatable");
  facts.fault = reader.text_or("fault", "");
  BITELINE_TRY(reader.finish());
  return facts;
}

std::string recording_facts_text(const RecordingFacts& facts) {
  char peaks[256];
  std::snprintf(peaks, sizeof peaks,
                "peaks: {mode: %s, choice: %s, threshold_grey: %.9g, width_min_px: %.9g, width_max_px: "
                "%.9g}\n",
                facts.peak_mode.c_str(), facts.peak_choice.c_str(), facts.peak_threshold_grey,
                facts.peak_width_min_px, facts.peak_width_max_px);
  std::string text = "# A live scan as biteline-sensor recorded it.\n";
  text += "sensor: " + quoted(facts.sensor) + "\nversion: " + quoted(facts.version) + "\n" + peaks;
  text += std::string{"second_exposures: "} + word(facts.second_exposures) +
          "\nlaser_off_frames: " + word(facts.laser_off_frames) + "\ncomplete: " + word(facts.complete) +
          "\n";
  const auto count = [&](const char* key, std::uint64_t value) {
    text += std::string{key} + ": " + std::to_string(value) + "\n";
  };
  if (facts.pictures_every != 1) count("pictures_every", facts.pictures_every);
  count("pictures", facts.pictures);
  count("pictures_left_out", facts.pictures_left_out);
  count("poses", facts.poses);
  count("poses_left_out", facts.poses_left_out);
  count("messages", facts.messages);
  count("messages_left_out", facts.messages_left_out);
  count("unrepeatable", facts.unrepeatable);
  if (!facts.fault.empty()) text += "fault: " + quoted(facts.fault) + "\n";
  return text;
}

}  // namespace biteline::session
