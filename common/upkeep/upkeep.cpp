// SPDX-License-Identifier: MIT
#include "common/upkeep/upkeep.hpp"

#include <cstdio>

#include "common/config/yaml_reader.hpp"

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

double hours(double seconds) {
  return seconds / 3600;
}

}  // namespace

Result<Upkeep> read_upkeep(const std::filesystem::path& file) {
  BITELINE_ASSIGN(config::YamlReader reader, config::YamlReader::open(file));
  Upkeep upkeep;
  upkeep.starts = count_of(reader, "starts");
  upkeep.boots = count_of(reader, "boots");
  upkeep.run_s = reader.number("run_s", k_count);
  upkeep.laser_s = reader.number("laser_s", k_count);
  upkeep.lightings = count_of(reader, "lightings");
  if (reader.has("hottest_degc")) upkeep.hottest_degc = reader.number("hottest_degc", k_degc);
  if (reader.has("coldest_degc")) upkeep.coldest_degc = reader.number("coldest_degc", k_degc);
  upkeep.up_s = reader.number("up_s", k_count);
  BITELINE_TRY(reader.finish());
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
  add("up_s", number_text(upkeep.up_s));
  return text;
}

std::string in_words(const Upkeep& upkeep) {
  char text[200];
  std::snprintf(text, sizeof text, "%llu starts, %llu boots, %.1f h run, laser on %.2f h in %llu times",
                static_cast<unsigned long long>(upkeep.starts), static_cast<unsigned long long>(upkeep.boots),
                hours(upkeep.run_s), hours(upkeep.laser_s),
                static_cast<unsigned long long>(upkeep.lightings));
  std::string words = text;
  if (upkeep.coldest_degc && upkeep.hottest_degc) {
    std::snprintf(text, sizeof text, ", head %.0f to %.0f degC", *upkeep.coldest_degc, *upkeep.hottest_degc);
    words += text;
  }
  return words;
}

}  // namespace biteline::upkeep
