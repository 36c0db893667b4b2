// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/metrics.hpp"

#include <array>
#include <string_view>

#include "host/interfaces/control/exposition.hpp"

namespace biteline::web {
namespace {

using control::Exposition;
using control::Json;
using control::metric_label;

/// The number or truth value of a field, if it has one.
const Json* number_in(const Json& object, std::string_view field) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(field);
  if (found == object.end() || !(found->is_number() || found->is_boolean())) return nullptr;
  return &*found;
}

double as_number(const Json& json) {
  return json.is_boolean() ? (json.get<bool>() ? 1.0 : 0.0) : json.get<double>();
}

const Json& part(const Json& object, std::string_view field) {
  static const Json k_nothing;
  if (!object.is_object()) return k_nothing;
  const auto found = object.find(field);
  return found == object.end() ? k_nothing : *found;
}

void write_lamps(Exposition& out, const Json& lamps) {
  if (!lamps.is_object()) return;
  static constexpr std::array<std::string_view, 5> k_levels{"unknown", "off", "ok", "warning", "fault"};
  out.head("lamp", "gauge", "1 for the level that the lamp shows.");
  for (const auto& [lamp, shown] : lamps.items()) {
    for (const std::string_view level : k_levels) {
      const bool is = part(shown, "level") == Json(std::string{level});
      out.value(metric_label("lamp", lamp) + "," + metric_label("level", level), is ? 1 : 0);
    }
  }
}

struct SensorField {
  std::string_view group;  ///< the object within the sensor's; empty: the sensor's own
  std::string_view field;
  std::string_view name;
  std::string_view type;
  std::string_view help;
};
constexpr std::array k_sensor_fields{
    SensorField{"", "connected", "sensor_connected", "gauge", "1 while the sensor is heard."},
    SensorField{"", "temperature_degc", "sensor_temperature_degc", "gauge",
                "Temperature of the camera [degC]."},
    SensorField{"", "frames", "sensor_frames_total", "counter", "Frames taken."},
    SensorField{"", "frames_lost", "sensor_frames_lost_total", "counter", "Frames lost."},
    SensorField{"", "frames_damaged", "sensor_frames_damaged_total", "counter",
                "Frames that the driver marked bad."},
    SensorField{"", "profiles", "sensor_profiles_total", "counter", "Profiles made."},
    SensorField{"", "profiles_dropped", "sensor_profiles_dropped_total", "counter", "Profiles dropped."},
    SensorField{"", "messages_lost", "sensor_messages_lost_total", "counter", "Messages lost on the way."},
    SensorField{"", "poses_lost", "sensor_poses_lost_total", "counter", "Robot poses lost."},
    SensorField{"", "overruns", "sensor_overruns_total", "counter", "Frames processed late."},
    SensorField{"upkeep", "starts", "sensor_starts_total", "counter", "Starts of the sensor's program."},
    SensorField{"upkeep", "boots", "sensor_boots_total", "counter", "Boots of the unit."},
    SensorField{"upkeep", "run_s", "sensor_run_seconds_total", "counter", "The sensor's program ran [s]."},
    SensorField{"upkeep", "laser_s", "sensor_laser_seconds_total", "counter", "The laser was on [s]."},
    SensorField{"upkeep", "lightings", "sensor_lightings_total", "counter", "The laser went on."},
    SensorField{"upkeep", "frames", "sensor_unit_frames_total", "counter",
                "Frames since the unit was first started."},
    SensorField{"upkeep", "coldest_degc", "sensor_coldest_degc", "gauge",
                "Coldest that the head has been [degC]."},
    SensorField{"upkeep", "hottest_degc", "sensor_hottest_degc", "gauge",
                "Hottest that the head has been [degC]."},
};

void write_sensors(Exposition& out, const Json& body) {
  const Json& sensors = part(body, "sensors");
  if (!sensors.is_array()) return;
  for (const SensorField& field : k_sensor_fields) {
    bool headed = false;
    for (const Json& sensor : sensors) {
      const Json* number = number_in(field.group.empty() ? sensor : part(sensor, field.group), field.field);
      if (number == nullptr) continue;
      if (!headed) out.head(field.name, field.type, field.help);
      headed = true;
      const Json& name = part(sensor, "name");
      out.value(metric_label("sensor", name.is_string() ? name.get<std::string>() : ""), as_number(*number));
    }
  }
}

}  // namespace

std::string metrics_text(const ServerCounts& counts, const Json& state, const Json& sensors) {
  Exposition out{"biteline_"};
  out.one("host_up", "gauge", "1 while the service answers.", state.is_object() ? 1 : 0);
  write_lamps(out, part(state, "lamps"));
  if (const Json* last_s = number_in(part(state, "cycle"), "last_s")) {
    out.one("cycle_seconds", "gauge", "The last shoe, from the scan's begin to its end [s].",
            as_number(*last_s));
  }
  write_sensors(out, sensors);
  if (const Json* free_bytes = number_in(part(sensors, "disk"), "free_bytes")) {
    out.one("disk_free_bytes", "gauge", "Free space for results.", as_number(*free_bytes));
  }
  const auto as_double = [](std::uint64_t count) { return static_cast<double>(count); };
  out.one("web_requests_total", "counter", "Requests to this program.", as_double(counts.requests));
  out.one("web_refused_total", "counter", "Requests that this program refused.", as_double(counts.refused));
  out.one("web_forwarded_total", "counter", "Requests given to the service.", as_double(counts.forwarded));
  out.one("web_host_away_total", "counter", "Requests that found no service.", as_double(counts.host_away));
  out.one("web_connections", "gauge", "Open connections.", counts.connections);
  out.one("web_live_watchers", "gauge", "Clients of the live data.", counts.watchers);
  out.one("web_event_listeners", "gauge", "Clients of the events.", counts.listeners);
  out.one("web_live_pictures_total", "counter", "Live pictures taken in.", as_double(counts.pictures));
  out.one("web_live_profiles_total", "counter", "Live profiles taken in.", as_double(counts.profiles));
  return out.take();
}

}  // namespace biteline::web
