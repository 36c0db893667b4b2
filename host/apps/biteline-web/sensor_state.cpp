// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/sensor_state.hpp"

#include <nlohmann/json.hpp>

#include "common/settings/settings.hpp"
#include "host/interfaces/control/upkeep.hpp"
#include "host/report/json_text.hpp"

namespace biteline::web {
namespace {

using nlohmann::ordered_json;
using settings::Key;

/// As a request gives it back; null where nothing is said.
ordered_json bare(const settings::KeyRow& row, const std::optional<settings::Value>& value) {
  // Switches are off where nothing is said.
  if (!value && row.kind == settings::KeyRow::Kind::OnOff) return false;
  if (!value) return nullptr;
  switch (row.kind) {
    case settings::KeyRow::Kind::OnOff:
      return value->on;
    case settings::KeyRow::Kind::Word:
      return value->word;
    default:
      return value->number;
  }
}

const char* kind_of(const settings::KeyRow& row) {
  switch (row.kind) {
    case settings::KeyRow::Kind::OnOff:
      return "on_off";
    case settings::KeyRow::Kind::Word:
      return "word";
    case settings::KeyRow::Kind::Whole:
      return "whole";
    default:
      return "number";
  }
}

/// Every key with what it is now, and what it may be.
ordered_json settings_json(const settings::SettingsSet& set) {
  ordered_json rows = ordered_json::array();
  for (std::size_t i = 0; i < settings::k_key_count; ++i) {
    const auto key = static_cast<Key>(i);
    const settings::KeyRow& row = settings::row_of(key);
    const auto& value = set.at(key);
    ordered_json one{{"key", settings::path_of(key)},
                     {"value", value ? settings::value_text(key, *value) : row.usual},
                     {"now", bare(row, value)},
                     {"kind", kind_of(row)},
                     {"unit", row.unit},
                     {"what", row.what}};
    const bool number =
        row.kind == settings::KeyRow::Kind::Number || row.kind == settings::KeyRow::Kind::Whole;
    if (number) one["range"] = {row.range.minimum, row.range.maximum};
    if (!row.words.empty()) one["words"] = row.words;
    rows.push_back(std::move(one));
  }
  return rows;
}

ordered_json trigger_json(const wire::TriggerState& trigger) {
  return {{"edges", trigger.edges},
          {"edges_missed", trigger.edges_missed},
          {"edges_lost", trigger.edges_lost},
          {"frames_paired", trigger.frames_paired},
          {"frames_without_edge", trigger.frames_without_edge}};
}

}  // namespace

std::string sensor_state(const wire::SensorHello& sensor, const wire::Health& health) {
  const geometry::Region& region = sensor.model.region;
  ordered_json json{
      {"name", sensor.name},
      {"version", sensor.version},
      {"simulated", sensor.simulated},
      {"recording", sensor.lossless},
      {"scanning", health.scanning},
      {"laser", health.laser == wire::LaserState::On      ? "on"
                : health.laser == wire::LaserState::Fault ? "fault"
                                                          : "off"},
      {"laser_reason", health.laser_reason},
      {"region_px", {region.offset_u_px, region.offset_v_px, region.width_px, region.height_px}},
      {"frames", health.counters.frames},
      {"frames_lost", health.counters.frames_lost},
      {"frames_damaged", health.counters.frames_damaged},
      {"profiles", health.counters.profiles},
      {"observers", health.observers},
      {"triggered_by_software", health.devices.trigger_by_software}};
  if (health.devices.temperature_degc) json["temperature_degc"] = *health.devices.temperature_degc;
  if (health.devices.trigger) json["trigger"] = trigger_json(*health.devices.trigger);
  if (health.devices.capture && health.devices.capture->rate_max_hz > 0)
    json["rate_max_hz"] = health.devices.capture->rate_max_hz;
  if (health.upkeep) json["upkeep"] = control::to_json(*health.upkeep);
  if (!health.settings) return report::to_text(json);
  if (health.settings->rate_max_hz > 0) json["rate_max_hz"] = health.settings->rate_max_hz;
  json["changes"] = health.settings->changes;
  if (const auto set = settings::parse_settings(health.settings->text, "settings in use"))
    json["settings"] = settings_json(*set);
  return report::to_text(json);
}

}  // namespace biteline::web
