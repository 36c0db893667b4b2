// SPDX-License-Identifier: MIT
#include "host/interfaces/api/process_schema.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "host/robot/path/process.hpp"

namespace biteline::api {
namespace {

using config::KeyAsked;
using control::Json;

struct Help {
  std::string_view path, text;
};

constexpr std::array k_help{
    Help{"name", "Words for people"},
    Help{"tool.name", "Name of the tool that must be mounted; empty: nobody asks"},
    Help{"tool.tcp_position_mm", "Tip of the tool, seen from the flange"},
    Help{"tool.tcp_rotation_deg", "Turn of the tool against the flange, as a rotation vector"},
    Help{"tool.body_radius_mm", "Radius of the tool's body, round its axis"},
    Help{"tool.contact_length_mm", "Part of the tip that may come near the shoe"},
    Help{"tool.free_turn_deg", "How far the tool may turn about its own axis; 180: it is round"},
    Help{"tool.payload_centre_mm", "Centre of mass of what the flange carries"},
    Help{"tool.payload_kg", "Mass of what the flange carries"},
    Help{"placement.outwards", "What outwards is: level, or along the upper's own normal"},
    Help{"placement.outward_mm", "Tip beside the line, outwards"},
    Help{"placement.up_mm", "Tip beside the line, upwards"},
    Help{"placement.standoff_mm", "Tip back along the tool, as for a spray"},
    Help{"placement.tilt_deg", "0: the tool is level; 90: it points straight down"},
    Help{"placement.lead_deg", "Above 0 the tool's body leans back"},
    Help{"coverage.contact_width_mm", "Width that the tool covers at once"},
    Help{"coverage.cone_deg", "Full angle of a spray's cone"},
    Help{"motion.speed_mm_s", "Speed along the line"},
    Help{"motion.minimum_speed_mm_s", "A path that must be slower is refused"},
    Help{"motion.acceleration_mm_s2", "Along the path"},
    Help{"motion.cross_acceleration_mm_s2", "In curves"},
    Help{"motion.joint_speed_ratio", "Of the arm's own limits"},
    Help{"motion.give_mm", "Slower where the arm would give more, across the line; 0: not asked for"},
    Help{"motion.spacing_mm", "Between the program's targets"},
    Help{"motion.blend_mm", "Radius of the blend round a target"},
    Help{"motion.chord_error_mm", "How far straight moves and blends may leave the line"},
    Help{"motion.overlap_mm", "Beyond the starting point, so that the seam is covered"},
    Help{"motion.approach_mm", "Way in, along the tool's axis"},
    Help{"motion.approach_speed_mm_s", "Speed of the way in and out"},
    Help{"motion.draw_back_mm", "Farther back along the tool's axis, fast"},
    Help{"motion.lift_mm", "Straight up, before and after"},
    Help{"motion.transfer_speed_mm_s", "Speed between places above the shoe"},
    Help{"follow.off_path_mm", "The arm is stopped when its tip is farther from the path"},
    Help{"follow.off_path_deg", "The arm is stopped when its tool is turned farther from the path"},
    Help{"follow.off_way_deg", "The same of a joint on the way to the path"},
    Help{"follow.late_s", "The arm is stopped when it is farther behind or ahead of the plan"},
    Help{"follow.stall_s", "The arm is stopped when it does not come on for so long"},
    Help{"follow.silence_s", "The arm is stopped when its controller says nothing for so long"},
    Help{"follow.covered", "Share of the line that must be worked, or the job is not done"},
    Help{"gate.scan_age_s", "Nothing is sent when the scan ended longer ago"},
    Help{"gate.lost_in_a_row", "Frames, profiles or edges that a scan may lack in a row"},
    Help{"gate.start_deg", "How far a joint may have moved since its way was checked"},
    Help{"gate.approval",
         "Who lets a line be sent: nobody needs to, a person, or automatic above a confidence"},
    Help{"gate.automatic_above", "With automatic approval: a line at least as sure as this needs no person"},
    Help{"gate.tolerance_mm", "Nothing is sent when the line is less certain (U95); 0: not asked for"},
    Help{"gate.tip_tolerance_mm",
         "Nothing is sent when the tool may be farther off the line; 0: not asked for"},
    Help{"start", "Where the closed line is entered"},
    Help{"after_work",
         "What follows the work: nothing, a second look, or a look and once more what is missing"},
    Help{"look_tolerance_mm", "Of the second look: an edge farther off its place is a fault"},
    Help{"next_process", "Process that the same shoe is worked with then; empty: none"},
    Help{"foot", "The foot that stretches are told on; on the other one they are mirrored"},
    Help{"zones", "Parts of the line that are worked in their own way, or left out; the first one counts"},
    Help{"zones[].name", "Words for people"},
    Help{"zones[].where", "A stretch of the line, or what of it lies at the shoe's heel or toe"},
    Help{"zones[].from_percent",
         "Of a stretch: its beginning, of the line's length from the heel's end, anticlockwise from above"},
    Help{"zones[].to_percent", "Its end; smaller than the beginning: it runs over the heel's end"},
    Help{"zones[].reach_percent", "Of heel and toe: how far they reach, of the shoe's length"},
    Help{"zones[].work", "Worked, or left out: then the tool is off and passes it lifted"},
    Help{"zones[].outward_by_mm", "Added to the placement's"},
    Help{"zones[].up_by_mm", "Added to the placement's"},
    Help{"zones[].tilt_by_deg", "Added to the placement's"},
    Help{"zones[].lead_by_deg", "Added to the placement's"},
    Help{"zones[].speed_ratio", "Of the process's speed"},
    Help{"zones[].passes", "How often it is worked; after the first the tool comes back to it"},
    Help{"zones[].ramp_mm", "Within its ends, over which offsets and angles change"},
    Help{"digital_output", "Output that is on along the line; -1: none"},
    Help{"flow.gun_on_ms", "From the output's switching on until it is on the shoe; the tool waits so long"},
    Help{"flow.gun_off_ms", "From its switching off until nothing comes; it is switched off so long before"},
    Help{"flow.dwell_ms", "How long the tool stands at its beginning then"},
    Help{"flow.film_overlap_mm", "Film on film where the line closes; the rest of the overlap stays dry"},
    Help{"flow.analog_output", "Output that goes with the speed of the place that is worked; -1: none"},
    Help{"flow.full_mm_s", "Speed at which it is full; 0: the line's fastest"},
    Help{"flow.lag_ms", "How long the flow follows the analog output; the output is ahead by so much"},
    Help{"flow.purge_ms", "How long the gun is open beside the shoe before the line; 0: not at all"},
    Help{"flow.purge_x_mm", "Place of the tip then, in the arm's base; the tool points straight down"},
    Help{"flow.purge_y_mm", "Likewise"},
    Help{"flow.purge_z_mm", "Likewise, upwards"},
    Help{"force.set_n", "How hard the tool presses, against the upper's own normal; 0: by position alone"},
    Help{"force.by", "The arm's force mode, or a device between arm and tool that keeps the force by itself"},
    Help{"force.flange_full_n", "At the full analog output, and at 10 V of the reading"},
    Help{"force.flange_stroke_mm", "The whole of it; in its middle the tip stands at its place"},
    Help{"force.flange_tilt_deg", "Of its axis from the tool's, about the line; default placement.tilt_deg"},
    Help{"force.flange_analog_output", "0 or 1: the set force"},
    Help{"force.flange_analog_input", "0 or 1: what it reads"},
    Help{"force.flange_on_output", "0 to 7: it presses"},
    Help{"force.flange_ready_input", "0 to 7: no fault, and not at an end of its stroke"},
    Help{"force.contact_n", "From here on the tool touches; the force grows from it as the tool sets out"},
    Help{"force.approach_mm_s", "Speed of the tip until it touches"},
    Help{"force.reach_mm", "How far the tip may leave its path along the force, either way"},
    Help{"force.ramp_mm", "Over which the force grows and falls at the ends of each run"},
    Help{"force.limit_mm_s", "Highest speed of the tip along the force"},
    Help{"force.damping", "Of the arm's force mode, 0 to 1"},
    Help{"force.gain", "Of the arm's force mode; a soft tool takes more, a hard shoe less"},
    Help{"force.most_n", "Above it the run ends"},
    Help{"force.lost_ms", "Without contact for so long the run ends"},
    Help{"force.tolerance_percent",
         "Of the set force; farther off for follow.stall_s the run is stopped; 0: not watched"},
};

Json bounds_of(const KeyAsked& key) {
  Json number{{"type", key.kind == KeyAsked::Kind::Integer ? "integer" : "number"}};
  constexpr double k_unbounded = 1e8;
  if (key.range.minimum > -k_unbounded) number["minimum"] = key.range.minimum;
  if (key.range.maximum < k_unbounded) number["maximum"] = key.range.maximum;
  return number;
}

Json schema_of(const KeyAsked& key) {
  Json schema;
  switch (key.kind) {
    case KeyAsked::Kind::Number:
    case KeyAsked::Kind::Integer:
      schema = bounds_of(key);
      break;
    case KeyAsked::Kind::Numbers:
      schema = {
          {"type", "array"}, {"items", bounds_of(key)}, {"minItems", key.count}, {"maxItems", key.count}};
      break;
    case KeyAsked::Kind::Text:
      schema = {{"type", "string"}};
      break;
    case KeyAsked::Kind::Choice:
      schema = {{"type", "string"}, {"enum", key.choices}};
      break;
  }
  if (key.default_number) schema["default"] = *key.default_number;
  if (key.default_text) schema["default"] = *key.default_text;
  if (const std::string unit = unit_of(key.path); !unit.empty()) schema["x-unit"] = unit;
  schema["description"] = help_of(key.path);
  return schema;
}

/// "zones[2].name": of a list's item.
struct ItemKey {
  std::string list, name;
  std::size_t index;
};
std::optional<ItemKey> item_key(const std::string& path) {
  const std::size_t open = path.find('['), close = path.find("].");
  if (open == std::string::npos || close == std::string::npos) return std::nullopt;
  return ItemKey{.list = path.substr(0, open),
                 .name = path.substr(close + 2),
                 .index = std::strtoul(path.c_str() + open + 1, nullptr, 10)};
}

Json value_of(const KeyAsked& key) {
  if (key.text) return *key.text;
  if (key.numbers.empty()) return {};
  if (key.kind == KeyAsked::Kind::Numbers) return key.numbers;
  if (key.kind == KeyAsked::Kind::Integer) return static_cast<std::int64_t>(key.numbers.front());
  return key.numbers.front();
}

}  // namespace

std::string unit_of(const std::string& key) {
  constexpr std::array k_units{Help{"_mm_s2", "mm/s2"}, Help{"_mm_s", "mm/s"}, Help{"_mm", "mm"},
                               Help{"_deg", "degrees"}, Help{"_kg", "kg"},     Help{"_ms", "ms"},
                               Help{"_s", "s"},         Help{"_percent", "%"}, Help{"_n", "N"}};
  for (const Help& unit : k_units) {
    if (key.ends_with(unit.path)) return std::string{unit.text};
  }
  return {};
}

std::string help_of(const std::string& path) {
  const std::optional<ItemKey> item = item_key(path);
  const std::string wanted = item ? item->list + "[]." + item->name : path;
  for (const Help& help : k_help) {
    if (help.path == wanted) return std::string{help.text};
  }
  return {};
}

Json process_schema() {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", "Process"},
              {"type", "object"},
              {"additionalProperties", false},
              {"required", Json::array()},
              {"properties", Json::object()}};
  for (const KeyAsked& key : path::process_keys()) {
    Json* parent = &schema;
    std::string name = key.path;
    if (const std::optional<ItemKey> item = item_key(key.path)) {
      name = item->name;
      Json& list = schema["properties"][item->list];
      if (list.is_null()) {
        list = {
            {"type", "array"},
            {"maxItems", path::k_most_zones},
            {"description", help_of(item->list)},
            {"items", {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}}}};
      }
      parent = &list["items"];
    } else if (const std::size_t dot = name.find('.'); dot != std::string::npos) {
      const std::string group = name.substr(0, dot);
      name = name.substr(dot + 1);
      parent = &schema["properties"][group];
      if (parent->is_null())
        *parent = {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
      if (key.required) {
        // A group with a key that must be there must be there itself.
        Json& groups = schema["required"];
        if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
      }
    }
    (*parent)["properties"][name] = schema_of(key);
    if (key.required) (*parent)["required"].push_back(name);
  }
  return schema;
}

Json process_json(const config::KeysAsked& keys) {
  Json process = Json::object();
  for (const KeyAsked& key : keys) {
    Json value = value_of(key);
    if (value.is_null()) continue;
    const std::size_t dot = key.path.find('.');
    if (const std::optional<ItemKey> item = item_key(key.path)) {
      process[item->list][item->index][item->name] = std::move(value);
    } else if (dot == std::string::npos) {
      process[key.path] = std::move(value);
    } else {
      process[key.path.substr(0, dot)][key.path.substr(dot + 1)] = std::move(value);
    }
  }
  return process;
}

}  // namespace biteline::api
