// SPDX-License-Identifier: MIT
#include "host/records/mounted/mounted_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace biteline::mounted {
namespace {

using nlohmann::ordered_json;

constexpr const char* k_key = "mounted";
constexpr std::array k_parts{"tip", "payload", "table", "tool", "lines", "renewed"};
/// Older records know no names.
constexpr std::size_t k_parts_always = 3;
constexpr double k_farthest_mm = 1000;  // as of a process's tip and centre of mass
constexpr double k_most_kg = 20;
constexpr double k_highest_mm = 5000;  // of a table, from the robot's base
constexpr int k_last_line = 7;         // of a controller's standard digital lines

ordered_json list(const Vec3& v) {
  return ordered_json::array({v.x(), v.y(), v.z()});
}

void tell(const Taught& how, ordered_json& json) {
  json["version"] = how.version;
  json["who"] = how.who;
  json["time"] = memory::to_iso(how.time);
  if (how.touches == 0) return;
  json["touches"] = how.touches;
  json["residual_mm"] = how.residual_mm;
  json["u95_mm"] = how.u95_mm;
}

/// Numbers as JSON has them, finite and within the range; the first fault stays.
struct Reader {
  const ordered_json& json;
  bool& good;

  [[nodiscard]] double number(const char* name, double least, double most) const {
    const auto found = json.find(name);
    const double value = found != json.end() && found->is_number() ? found->get<double>() : NAN;
    if (value >= least && value <= most) return value;
    good = false;
    return 0;
  }
  [[nodiscard]] Vec3 vector(const char* name) const {
    const auto found = json.find(name);
    Vec3 v = Vec3::Zero();
    if (found == json.end() || !found->is_array() || found->size() != 3) {
      good = false;
      return v;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if ((*found)[i].is_number()) {
        v[static_cast<Eigen::Index>(i)] = (*found)[i].get<double>();
      } else {
        good = false;
      }
    }
    good = good && v.norm() <= k_farthest_mm;
    return v;
  }
  [[nodiscard]] Taught how() const {
    Taught out;
    out.version = static_cast<int>(number("version", 1, 1e9));
    const auto who = json.find("who"), time = json.find("time");
    if (who == json.end() || !who->is_string() || time == json.end() || !time->is_string()) {
      good = false;
      return out;
    }
    out.who = who->get<std::string>();
    const std::optional<memory::UnixMs> at = memory::from_iso(time->get<std::string>());
    good = good && at.has_value();
    out.time = at.value_or(0);
    if (!json.contains("touches")) return out;
    out.touches = static_cast<int>(number("touches", 1, 1000));
    out.residual_mm = number("residual_mm", 0, k_farthest_mm);
    out.u95_mm = number("u95_mm", 0, k_farthest_mm);
    return out;
  }
};

/// Keeps `record` with its next version's number, already in the part that changed.
Result<Record> keep(memory::Memory& memory, const Record& before, Record now, Part part, const Hand& hand,
                    const char* action) {
  now.version = before.version + 1;
  BITELINE_TRY(memory.put_setting(k_key, to_json(now).dump(),
                                  {.id = 0,
                                   .time = memory::now_ms(),
                                   .who = hand.who,
                                   .door = hand.door,
                                   .action = action,
                                   .subject = name_of(part),
                                   .before = to_json(before, part).dump(),
                                   .after = to_json(now, part).dump()}));
  return now;
}

/// Two tools may be switched on by one output; a changer's place has lines of its own.
bool clash(const path::ToolLines& one, const path::ToolLines& other) {
  const auto asks_by = [](const path::ToolLines& lines, std::optional<int> output) {
    return lines.changer && output == lines.changer->ask_output;
  };
  if (asks_by(one, other.on_output) || asks_by(other, one.on_output)) return true;
  if (!one.changer || !other.changer) return false;
  return one.changer->ask_output == other.changer->ask_output ||
         one.changer->there_input == other.changer->there_input;
}

Taught taught(const Record& before, const Hand& hand) {
  return {.version = before.version + 1, .who = hand.who, .time = memory::now_ms()};
}

}  // namespace

namespace {

/// Nobody knows what is on the flange where no tool is named, and a tool that a person mounts is in the way.
std::optional<path::Changer> changer_for(const Record& record, const std::string& name) {
  if (!record.tool || !record.lines || !record.lines->lines.changer) return std::nullopt;
  path::Changer changer;
  bool has = false;
  const auto add = [&](const std::string& tool, const std::optional<Lines>& lines,
                       const std::optional<Tip>& tip) {
    if (!lines || !lines->lines.changer) return;
    if (tool == name) {
      has = true;
      changer.wanted = *lines->lines.changer;
    } else {
      changer.others.push_back(*lines->lines.changer);
    }
    if (tip) changer.reach_mm = std::max(changer.reach_mm, tip->tip_flange.norm());
  };
  add(record.tool->name, record.lines, record.tip);
  for (const auto& [tool, taught] : record.shelf) add(tool, taught.lines, taught.tip);
  return has ? std::optional{changer} : std::nullopt;
}

}  // namespace

path::Mounted Record::mounted(const std::string& name) const {
  path::Mounted out;
  if (tool) out.tool = tool->name;
  const bool other = !name.empty() && out.tool != name;
  const auto found = shelf.find(name);
  const ShelvedTool taught = !other ? ShelvedTool{.tip = tip, .payload = payload, .lines = lines}
                             : found == shelf.end() ? ShelvedTool{}
                                                    : found->second;
  if (taught.tip) {
    out.tip_flange = taught.tip->tip_flange;
    out.tip_u95_mm = taught.tip->how.u95_mm;
  }
  if (taught.payload) out.payload = taught.payload->payload;
  if (taught.lines) out.lines = taught.lines->lines;
  if (!name.empty()) out.changer = changer_for(*this, name);
  if (table) out.table_z_mm = table->z_mm;
  return out;
}

const char* name_of(Part part) {
  return k_parts.at(static_cast<std::size_t>(part));
}

std::optional<Part> part_of(const std::string& name) {
  for (std::size_t i = 0; i < k_parts.size(); ++i)
    if (name == k_parts.at(i)) return static_cast<Part>(i);
  return std::nullopt;
}

namespace {

ordered_json json_of(const std::optional<Tip>& tip) {
  ordered_json json;
  if (!tip) return json;
  json["at_mm"] = list(tip->tip_flange);
  tell(tip->how, json);
  return json;
}

ordered_json json_of(const std::optional<Load>& load) {
  ordered_json json;
  if (!load) return json;
  json["kg"] = load->payload.mass_kg;
  json["centre_mm"] = list(load->payload.centre_flange_mm);
  tell(load->how, json);
  return json;
}

ordered_json json_of(const std::optional<Lines>& lines) {
  ordered_json json;
  if (!lines) return json;
  if (lines->lines.on_output) json["on_output"] = *lines->lines.on_output;
  if (lines->lines.changer) {
    json["ask_output"] = lines->lines.changer->ask_output;
    json["there_input"] = lines->lines.changer->there_input;
  }
  tell(lines->how, json);
  return json;
}

std::optional<Tip> tip_of(const ordered_json& json, bool& good) {
  if (!json.is_object()) return std::nullopt;
  return Tip{.tip_flange = Reader{json, good}.vector("at_mm"), .how = Reader{json, good}.how()};
}

std::optional<Load> load_of(const ordered_json& json, bool& good) {
  if (!json.is_object()) return std::nullopt;
  return Load{.payload = {.mass_kg = Reader{json, good}.number("kg", 0, k_most_kg),
                          .centre_flange_mm = Reader{json, good}.vector("centre_mm")},
              .how = Reader{json, good}.how()};
}

/// Older records know nothing of it.
std::optional<Lines> lines_of(const ordered_json& json, bool& good) {
  const auto found = json.find("lines");
  if (found == json.end() || found->is_null()) return std::nullopt;
  good = good && found->is_object();
  if (!good) return std::nullopt;
  const auto number = [&](const char* name) {
    return static_cast<int>(Reader{*found, good}.number(name, 0, k_last_line));
  };
  Lines lines{.lines = {}, .how = Reader{*found, good}.how()};
  if (found->contains("on_output")) lines.lines.on_output = number("on_output");
  if (found->contains("ask_output"))
    lines.lines.changer = {.ask_output = number("ask_output"), .there_input = number("there_input")};
  return lines;
}

/// As above.
std::optional<Taught> renewed_of(const ordered_json& json, bool& good) {
  const auto found = json.find("renewed");
  if (found == json.end() || found->is_null()) return std::nullopt;
  good = good && found->is_object();
  return good ? std::optional{Reader{*found, good}.how()} : std::nullopt;
}

ordered_json json_of(const std::optional<Taught>& how) {
  ordered_json json;
  if (how) tell(*how, json);
  return json;
}

/// Null or an object; of anything else nobody knows what was taught.
bool is_part(const ordered_json& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && (found->is_null() || found->is_object());
}

void read_tools(const ordered_json& json, Record& record, bool& good) {
  if (const auto tool = json.find("tool"); tool != json.end() && !tool->is_null()) {
    good = good && tool->is_object() && tool->contains("name") && (*tool)["name"].is_string();
    if (good)
      record.tool = MountedTool{.name = (*tool)["name"].get<std::string>(), .how = Reader{*tool, good}.how()};
  }
  const auto shelf = json.find("shelf");
  if (shelf == json.end()) return;
  good = good && shelf->is_object();
  if (!good) return;
  for (const auto& [name, taught] : shelf->items()) {
    good = good && taught.is_object() && is_part(taught, "tip") && is_part(taught, "payload");
    if (good)
      record.shelf[name] = {.tip = tip_of(taught["tip"], good),
                            .payload = load_of(taught["payload"], good),
                            .lines = lines_of(taught, good),
                            .renewed = renewed_of(taught, good)};
  }
}

/// What is mounted goes with its name; without one it stays where it is.
void shelve(Record& record) {
  if (!record.tool) return;
  record.shelf[record.tool->name] = {.tip = std::exchange(record.tip, {}),
                                     .payload = std::exchange(record.payload, {}),
                                     .lines = std::exchange(record.lines, {}),
                                     .renewed = std::exchange(record.renewed, {})};
  record.tool.reset();
}

}  // namespace

ordered_json to_json(const Record& record, Part part) {
  ordered_json json;
  switch (part) {
    case Part::Tip:
      return json_of(record.tip);
    case Part::Payload:
      return json_of(record.payload);
    case Part::Lines:
      return json_of(record.lines);
    case Part::Renewed:
      return json_of(record.renewed);
    case Part::Tool:
      if (!record.tool) return json;
      json["name"] = record.tool->name;
      tell(record.tool->how, json);
      return json;
    case Part::Table:
      if (!record.table) return json;
      json["z_mm"] = record.table->z_mm;
      if (record.table->tip_version > 0) json["tip_version"] = record.table->tip_version;
      tell(record.table->how, json);
      return json;
  }
  return json;
}

ordered_json to_json(const Record& record) {
  ordered_json shelf = ordered_json::object();
  for (const auto& [name, taught] : record.shelf)
    shelf[name] = {{"tip", json_of(taught.tip)},
                   {"payload", json_of(taught.payload)},
                   {"lines", json_of(taught.lines)},
                   {"renewed", json_of(taught.renewed)}};
  return {{"version", record.version},
          {"tool", to_json(record, Part::Tool)},
          {"shelf", std::move(shelf)},
          {"tip", to_json(record, Part::Tip)},
          {"payload", to_json(record, Part::Payload)},
          {"lines", to_json(record, Part::Lines)},
          {"renewed", to_json(record, Part::Renewed)},
          {"table", to_json(record, Part::Table)}};
}

Result<Record> read_record(const memory::Memory& memory) {
  BITELINE_ASSIGN(const std::optional<std::string> text, memory.setting(k_key));
  Record record;
  if (!text) return record;
  const ordered_json json = ordered_json::parse(*text, nullptr, false);
  bool good = json.is_object();
  for (std::size_t i = 0; i < k_parts_always; ++i) good = good && is_part(json, k_parts.at(i));
  if (good) {
    record.version = static_cast<int>(Reader{json, good}.number("version", 0, 1e9));
    record.tip = tip_of(json["tip"], good);
    record.payload = load_of(json["payload"], good);
    record.lines = lines_of(json, good);
    record.renewed = renewed_of(json, good);
    read_tools(json, record, good);
    if (const ordered_json& table = json["table"]; table.is_object())
      record.table =
          Table{.z_mm = Reader{table, good}.number("z_mm", -k_highest_mm, k_highest_mm),
                .tip_version = table.contains("tip_version")
                                   ? static_cast<int>(Reader{table, good}.number("tip_version", 1, 1e9))
                                   : 0,
                .how = Reader{table, good}.how()};
  }
  if (good) return record;
  return fail(Errc::BadFormat, "%.150s: what is mounted cannot be read; forget the tip, then teach all anew",
              memory.file().c_str());
}

Result<Record> keep_touched(memory::Memory& memory, kinematics::TouchLesson::Part part,
                            const kinematics::Touched& touched, std::size_t touches, const Hand& hand) {
  BITELINE_ASSIGN(const Record before, read_record(memory));
  Record now = before;
  Taught how = taught(before, hand);
  how.touches = static_cast<int>(touches);
  how.residual_mm = touched.residual_mm;
  how.u95_mm = touched.u95_mm;
  const bool tip = part == kinematics::TouchLesson::Part::Tip;
  if (tip && !(touched.tip_flange.norm() <= k_farthest_mm)) {
    return fail(Errc::BadValue, "tip %.0f mm from the flange: within %.0f mm expected; touch again",
                touched.tip_flange.norm(), k_farthest_mm);
  }
  if (tip) {
    now.tip = Tip{.tip_flange = touched.tip_flange, .how = how};
  } else {
    now.table =
        Table{.z_mm = touched.z_mm, .tip_version = before.tip ? before.tip->how.version : 0, .how = how};
  }
  return keep(memory, before, std::move(now), tip ? Part::Tip : Part::Table, hand, "teach");
}

Result<Record> keep_payload(memory::Memory& memory, const path::Payload& payload, const Hand& hand) {
  if (!(payload.mass_kg >= 0 && payload.mass_kg <= k_most_kg) ||
      !(payload.centre_flange_mm.norm() <= k_farthest_mm)) {
    return fail(Errc::BadValue, "payload: 0 to %.0f kg, and a centre within %.0f mm of the flange, expected",
                k_most_kg, k_farthest_mm);
  }
  BITELINE_ASSIGN(const Record before, read_record(memory));
  Record now = before;
  now.payload = Load{.payload = payload, .how = taught(before, hand)};
  return keep(memory, before, std::move(now), Part::Payload, hand, "teach");
}

Result<Record> keep_lines(memory::Memory& memory, const path::ToolLines& lines, const Hand& hand) {
  const auto is_line = [](int number) { return number >= 0 && number <= k_last_line; };
  const std::optional<path::ChangerLines>& changer = lines.changer;
  if ((lines.on_output && !is_line(*lines.on_output)) ||
      (changer && !(is_line(changer->ask_output) && is_line(changer->there_input))))
    return fail(Errc::BadValue, "lines of a tool: standard outputs and inputs 0 to %d expected", k_last_line);
  if (changer && lines.on_output == changer->ask_output)
    return fail(Errc::BadValue, "output %d cannot both switch the tool on and ask the changer for it",
                changer->ask_output);
  BITELINE_ASSIGN(const Record before, read_record(memory));
  if (!before.tool)
    return fail(Errc::WrongState, "nobody has said which tool is mounted; say its name first");
  for (const auto& [name, taught] : before.shelf)
    if (taught.lines && clash(lines, taught.lines->lines))
      return fail(Errc::BadValue, "one of these lines is that of '%.64s' already; see biteline mounted",
                  name.c_str());
  Record now = before;
  now.lines = Lines{.lines = lines, .how = taught(before, hand)};
  return keep(memory, before, std::move(now), Part::Lines, hand, "teach");
}

Result<Record> renew_tool(memory::Memory& memory, const Hand& hand) {
  BITELINE_ASSIGN(const Record before, read_record(memory));
  if (!before.tool)
    return fail(Errc::WrongState, "nobody has said which tool is mounted; say its name first");
  Record now = before;
  now.renewed = taught(before, hand);
  return keep(memory, before, std::move(now), Part::Renewed, hand, "teach");
}

Result<Record> mount_tool(memory::Memory& memory, const std::string& name, const Hand& hand) {
  if (!path::is_name(name))
    return fail(Errc::BadValue, "tool '%.64s': letters, digits, '.', '_' and '-' expected, at most 64",
                name.c_str());
  BITELINE_ASSIGN(const Record before, read_record(memory));
  Record now = before;
  const bool nameless = !now.tool && (now.tip || now.payload || now.lines || now.renewed);
  if (nameless && now.shelf.contains(name))
    return fail(
        Errc::WrongState,
        "a tip or payload was taught while no tool was named, and '%.64s' has its own; forget them, or "
        "give their tool another name first",
        name.c_str());
  const bool same = now.tool && now.tool->name == name;
  if (!same) shelve(now);
  if (const auto found = now.shelf.find(name); found != now.shelf.end()) {
    now.tip = found->second.tip;
    now.payload = found->second.payload;
    now.lines = found->second.lines;
    now.renewed = found->second.renewed;
    now.shelf.erase(found);
  }
  now.tool = MountedTool{.name = name, .how = taught(before, hand)};
  return keep(memory, before, std::move(now), Part::Tool, hand, "mount a tool");
}

Result<Record> forget(memory::Memory& memory, Part part, const Hand& hand) {
  const Result<Record> read = read_record(memory);
  // One that cannot be read goes whole: it could never be taught again.  A memory that is busy costs nothing.
  if (!read && read.error().code != Errc::BadFormat) return tl::unexpected<Error>{read.error()};
  const Record before = read ? *read : Record{};
  Record now = before;
  if (part == Part::Tip) now.tip.reset();
  if (part == Part::Payload) now.payload.reset();
  if (part == Part::Table) now.table.reset();
  if (part == Part::Lines) now.lines.reset();
  if (part == Part::Renewed) now.renewed.reset();
  if (part == Part::Tool) shelve(now);
  return keep(memory, before, std::move(now), part, hand, "forget what was taught");
}

}  // namespace biteline::mounted
