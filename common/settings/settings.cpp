// SPDX-License-Identifier: MIT
#include "common/settings/settings.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "common/config/yaml_reader.hpp"
#include "common/core/text.hpp"
#include "common/stripe/peak_names.hpp"
#include "common/system/file.hpp"

namespace biteline::settings {
namespace {

using Kind = KeyRow::Kind;

constexpr const char* k_of_head = "as sensor.yaml says";
constexpr const char* k_end_line = "...";
constexpr std::size_t k_longest_note_bytes = 200;

template <class T>
std::vector<std::string> names_in(const std::map<std::string, T>& table) {
  std::vector<std::string> names;
  for (const auto& [name, value] : table) names.push_back(name);
  return names;
}

/// Just as much as a float or a whole microsecond needs, and no more.
std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string words_expected(const KeyRow& row) {
  std::string text = "one of ";
  for (const std::string& word : row.words) text += (text.size() > 7 ? ", " : "") + word;
  return text;
}

std::string bare_text(const KeyRow& row, const Value& value) {
  switch (row.kind) {
    case Kind::OnOff:
      return value.on ? "true" : "false";
    case Kind::Word:
      return value.word;
    default:
      return number_text(value.number);
  }
}

/// What YAML ends a document with: the file was written to its end.
bool has_end(const std::string& text) {
  std::size_t end = text.find_last_not_of(" \r\n");
  if (end == std::string::npos || end < 2 || text.compare(end - 2, 3, k_end_line) != 0) return false;
  return end == 2 || text[end - 3] == '\n';
}

Value read_value(config::YamlReader& reader, const KeyRow& row) {
  Value value;
  const std::string key = row.name;
  switch (row.kind) {
    case Kind::Number:
      value.number = reader.number(key, row.range);
      break;
    case Kind::Whole:
      value.number = static_cast<double>(reader.integer(key, row.range));
      break;
    case Kind::OnOff:
      value.on = reader.boolean(key);
      break;
    case Kind::Word:
      value.word = reader.text(key);
      if (!std::ranges::count(row.words, value.word))
        reader.fault(Errc::BadValue, key, words_expected(row) + " expected");
      break;
  }
  value.line = reader.line_at(key);
  return value;
}

/// A key that a set may have is asked for only where it is: all are optional.
void read_group(config::YamlReader& root, const std::string& group, SettingsSet& set) {
  config::YamlReader reader = root.child(group, false);
  for (std::size_t i = 0; i < k_key_count; ++i) {
    const KeyRow& row = key_table()[i];
    if (row.group != group || !reader.has(row.name)) continue;
    set.set(static_cast<Key>(i), read_value(reader, row));
  }
}

/// What excludes each other within one set.
Result<void> check_together(const SettingsSet& set) {
  constexpr std::array k_region{Key::RegionLeft, Key::RegionTop, Key::RegionWidth, Key::RegionHeight};
  const auto told = [&](Key key) { return set.at(key).has_value(); };
  const auto region = std::ranges::find_if(k_region, told);
  if (region != k_region.end() && !std::ranges::all_of(k_region, told))
    return set.refuse(*region, "left_px, top_px, width_px and height_px together");
  const auto low = set.number(Key::PeakWidthMin), high = set.number(Key::PeakWidthMax);
  if (low && high && *low >= *high) return set.refuse(Key::PeakWidthMax, "more than width_min_px");
  if (told(Key::SecondExposureUs) && set.on(Key::LaserOffFrames).value_or(false))
    return set.refuse(Key::SecondExposureUs, "no laser_off_frames beside it");
  if (set.on(Key::AutoExposure).value_or(false) &&
      (told(Key::SecondExposureUs) || set.on(Key::LaserOffFrames).value_or(false)))
    return set.refuse(Key::AutoExposure, "neither second_exposure_us nor laser_off_frames beside it");
  if (set.on(Key::TestPattern).value_or(false) &&
      (told(Key::SecondExposureUs) || set.on(Key::LaserOffFrames).value_or(false) ||
       set.on(Key::AutoExposure).value_or(false) || set.on(Key::FollowStripe).value_or(false)))
    return set.refuse(Key::TestPattern,
                      "none of auto_exposure, follow_stripe, laser_off_frames, second_exposure_us beside it");
  const auto exposure = set.number(Key::ExposureUs), second = set.number(Key::SecondExposureUs);
  if (exposure && second && *second <= *exposure)
    return set.refuse(Key::SecondExposureUs, "more than exposure_us");
  return {};
}

}  // namespace

const std::array<KeyRow, k_key_count>& key_table() {
  static const std::array<KeyRow, k_key_count> table{{
      {Kind::Number, "camera", "exposure_us", {1, 1e7}, "us", k_of_head, "How long each picture is exposed"},
      {Kind::Number,
       "camera",
       "rate_hz",
       {1e-3, 1e5},
       "Hz",
       k_of_head,
       "Pictures a second, or trigger edges"},
      {Kind::Number,
       "camera",
       "gain",
       {0, 65535},
       "",
       "as the camera or board.yaml has it",
       "The camera's own number: dB on a network camera, the driver's steps on V4L2"},
      {Kind::Number,
       "camera",
       "second_exposure_us",
       {1, 1e6},
       "us",
       "none",
       "Every second picture so long, merged per column: black beside white"},
      {Kind::OnOff, "camera", "auto_exposure", {}, "", "off", "The exposure follows the surface"},
      {Kind::OnOff, "camera", "follow_stripe", {}, "", "off", "Only the rows about the stripe are taken"},
      {Kind::OnOff,
       "camera",
       "laser_off_frames",
       {},
       "",
       "off",
       "Every second picture without laser, taken off the next: against the room's light"},
      {Kind::OnOff,
       "camera",
       "test_pattern",
       {},
       "",
       "off",
       "A made stripe in place of each picture; the laser stays dark, and no scan is worked on"},
      {Kind::Whole, "region", "left_px", {0, 16384}, "px", k_of_head, "First column of the full sensor"},
      {Kind::Whole, "region", "top_px", {0, 16384}, "px", k_of_head, "First row of the full sensor"},
      {Kind::Whole, "region", "width_px", {16, 16384}, "px", k_of_head, "Columns"},
      {Kind::Whole, "region", "height_px", {16, 16384}, "px", k_of_head, "Rows; fewer are faster"},
      {Kind::Word,
       "peaks",
       "mode",
       {},
       "",
       "matched",
       "How the stripe's middle is found in a column",
       names_in(stripe::k_peak_modes)},
      {Kind::Word,
       "peaks",
       "choice",
       {},
       "",
       "continuity",
       "Which of several peaks in a column",
       names_in(stripe::k_peak_choices)},
      {Kind::Number,
       "peaks",
       "threshold_grey",
       {1, 254},
       "grey levels",
       "12",
       "A peak is at least so far above its background"},
      {Kind::Number, "peaks", "width_min_px", {0.1, 1000}, "px", "1.5", "Narrower peaks are no stripe"},
      {Kind::Number, "peaks", "width_max_px", {0.1, 1000}, "px", "24", "Wider peaks are no stripe"},
  }};
  return table;
}

const KeyRow& row_of(Key key) {
  return key_table()[static_cast<std::size_t>(key)];
}

std::string path_of(Key key) {
  return std::string{row_of(key).group} + "." + row_of(key).name;
}

std::optional<double> SettingsSet::number(Key key) const {
  return at(key) ? std::optional{at(key)->number} : std::nullopt;
}

std::optional<bool> SettingsSet::on(Key key) const {
  return at(key) ? std::optional{at(key)->on} : std::nullopt;
}

std::optional<std::string> SettingsSet::word(Key key) const {
  return at(key) ? std::optional{at(key)->word} : std::nullopt;
}

bool SettingsSet::empty() const {
  return std::ranges::none_of(values_, [](const auto& value) { return value.has_value(); });
}

tl::unexpected<Error> SettingsSet::refuse(Key key, const std::string& expected) const {
  const std::string place = path_of(key);
  const auto& value = at(key);
  if (!value)
    return fail(Errc::BadValue, "%s, %s: %s expected", file.c_str(), place.c_str(), expected.c_str());
  const std::string found = value_text(key, *value);
  return fail(Errc::BadValue, "%s line %d, %s: %s expected, found %s", file.c_str(), value->line,
              place.c_str(), expected.c_str(), found.c_str());
}

Result<SettingsSet> read_settings(const std::filesystem::path& file) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_settings_bytes));
  return parse_settings(text, file.string());
}

Result<SettingsSet> parse_settings(const std::string& text, const std::string& name) {
  if (!has_end(text))
    return fail(Errc::Truncated, "%s: the last line '...' is missing: the file is cut", name.c_str());
  BITELINE_ASSIGN(config::YamlReader reader, config::YamlReader::parse(text, name));
  SettingsSet set;
  set.file = name;
  set.note = reader.text_or("note", "");
  for (const char* group : {"camera", "region", "peaks"}) read_group(reader, group, set);
  BITELINE_TRY(reader.finish());
  BITELINE_TRY(check_together(set));
  return set;
}

std::string settings_text(const SettingsSet& set) {
  std::string text =
      "# Settings of a sensor in use.  What is not here is as sensor.yaml or the program has it.\n";
  std::string note = clean_text(set.note, k_longest_note_bytes);
  std::erase_if(note, [](char c) { return c == '"' || c == '\\'; });
  if (!note.empty()) text += "note: \"" + note + "\"\n";
  std::string group;
  for (std::size_t i = 0; i < k_key_count; ++i) {
    const KeyRow& row = key_table()[i];
    const auto& value = set.at(static_cast<Key>(i));
    if (!value) continue;
    if (group != row.group) text += std::string{row.group} + ":\n";
    group = row.group;
    text += "  " + std::string{row.name} + ": " + bare_text(row, *value) + "\n";
  }
  // An empty document is none.
  if (group.empty() && note.empty()) text += "note: \"\"\n";
  return text + k_end_line + "\n";
}

std::string value_text(Key key, const Value& value) {
  const KeyRow& row = row_of(key);
  if (row.kind == Kind::OnOff) return value.on ? "on" : "off";
  const std::string unit = row.unit;
  return bare_text(row, value) + (unit.empty() ? "" : " " + unit);
}

std::vector<Difference> compare(const SettingsSet& left, const SettingsSet& right) {
  std::vector<Difference> differences;
  for (std::size_t i = 0; i < k_key_count; ++i) {
    const Key key = static_cast<Key>(i);
    const auto &a = left.at(key), &b = right.at(key);
    if (a.has_value() == b.has_value() && (!a || a->same_as(*b))) continue;
    const std::string usual = row_of(key).usual;
    Difference one{
        .key = key, .left = a ? value_text(key, *a) : usual, .right = b ? value_text(key, *b) : usual};
    // "off" that is told is no other than "off" as usual.
    if (one.left != one.right) differences.push_back(std::move(one));
  }
  return differences;
}

}  // namespace biteline::settings
