// SPDX-License-Identifier: MIT
#include "common/upkeep/upkeep.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <sstream>

#include "common/config/yaml_reader.hpp"
#include "common/system/file.hpp"

namespace biteline::upkeep {
namespace {

constexpr NumberRange k_count{.minimum = 0, .maximum = 1e15};

std::uint64_t count_of(config::YamlReader& reader, const char* key) {
  return static_cast<std::uint64_t>(reader.number(key, k_count));
}

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

bool is_boot_id(const std::string& text) {
  return text.size() <= 64 && text.find_first_not_of("0123456789abcdef-") == std::string::npos;
}

constexpr std::array k_keys{"starts", "boots",        "run_s",        "laser_s", "lightings",
                            "frames", "hottest_degc", "coldest_degc", "boot_id"};

/// "key: value" of a key that is not of this program.
bool is_another_value(const std::string& line) {
  constexpr std::size_t k_most_bytes = 200;
  const std::size_t colon = line.find(": ");
  if (colon == 0 || colon == std::string::npos || line.size() > k_most_bytes) return false;
  const std::string key = line.substr(0, colon);
  return key.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos &&
         std::ranges::find(k_keys, key) == k_keys.end();
}

/// Takes those lines out of a file's text.
std::vector<std::string> take_others(std::string& text) {
  std::vector<std::string> others;
  std::istringstream lines{text};
  std::string own;
  for (std::string line; std::getline(lines, line);) {
    if (is_another_value(line)) {
      others.push_back(line);
    } else {
      own += line;
      own += '\n';
    }
  }
  text = own;
  return others;
}

double hours(double seconds) {
  return seconds / 3600;
}

}  // namespace

Result<Upkeep> read_upkeep(const std::filesystem::path& file) {
  BITELINE_ASSIGN(std::string text, read_regular_file(file, k_most_settings_bytes));
  Upkeep upkeep;
  upkeep.others = take_others(text);
  // Each alone is one plain value, or the file is not whole.
  for (const std::string& line : upkeep.others) {
    BITELINE_ASSIGN(config::YamlReader other, config::YamlReader::parse(line, file.string()));
    (void)other.text(line.substr(0, line.find(':')));
    BITELINE_TRY(other.finish());
  }
  BITELINE_ASSIGN(config::YamlReader reader, config::YamlReader::parse(text, file.string()));
  upkeep.starts = count_of(reader, "starts");
  upkeep.boots = count_of(reader, "boots");
  upkeep.run_s = reader.number("run_s", k_count);
  upkeep.laser_s = reader.number("laser_s", k_count);
  upkeep.lightings = count_of(reader, "lightings");
  if (reader.has("hottest_degc")) upkeep.hottest_degc = reader.number("hottest_degc", k_degc);
  if (reader.has("coldest_degc")) upkeep.coldest_degc = reader.number("coldest_degc", k_degc);
  // An older program counted none.
  if (reader.has("frames")) upkeep.frames = count_of(reader, "frames");
  upkeep.boot_id = reader.text_or("boot_id", "");
  BITELINE_TRY(reader.finish());
  if (!is_boot_id(upkeep.boot_id)) {
    return fail(Errc::BadValue, "%s: boot_id: hexadecimal digits and dashes expected", file.c_str());
  }
  return upkeep;
}

std::string upkeep_text(const Upkeep& upkeep) {
  std::string text =
      "# What this unit has been through.  Written by biteline-sensor; remove it and it begins anew.\n";
  const auto add = [&text](const char* key, const std::string& value) {
    text += key;
    text += ": ";
    text += value;
    text += "\n";
  };
  add("starts", std::to_string(upkeep.starts));
  add("boots", std::to_string(upkeep.boots));
  add("run_s", number_text(upkeep.run_s));
  add("laser_s", number_text(upkeep.laser_s));
  add("lightings", std::to_string(upkeep.lightings));
  if (upkeep.hottest_degc) add("hottest_degc", number_text(*upkeep.hottest_degc));
  if (upkeep.coldest_degc) add("coldest_degc", number_text(*upkeep.coldest_degc));
  add("frames", std::to_string(upkeep.frames));
  if (!upkeep.boot_id.empty()) add("boot_id", '"' + upkeep.boot_id + '"');
  for (const std::string& line : upkeep.others) {
    text += line;
    text += "\n";
  }
  return text;
}

std::string in_words(const Upkeep& upkeep) {
  char text[200];
  std::snprintf(text, sizeof text, "%llu starts, %llu boots, %.1f h run, laser on %.2f h in %llu times",
                static_cast<unsigned long long>(upkeep.starts), static_cast<unsigned long long>(upkeep.boots),
                hours(upkeep.run_s), hours(upkeep.laser_s),
                static_cast<unsigned long long>(upkeep.lightings));
  std::string words = text;
  if (upkeep.frames > 0) {
    std::snprintf(text, sizeof text, ", %llu frames", static_cast<unsigned long long>(upkeep.frames));
    words += text;
  }
  if (upkeep.coldest_degc && upkeep.hottest_degc) {
    std::snprintf(text, sizeof text, ", head %.0f to %.0f degC", *upkeep.coldest_degc, *upkeep.hottest_degc);
    words += text;
  }
  return words;
}

}  // namespace biteline::upkeep
