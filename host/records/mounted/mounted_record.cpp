// SPDX-License-Identifier: MIT
#include "host/records/mounted/mounted_record.hpp"

#include <array>
#include <cmath>

namespace biteline::mounted {
namespace {

using nlohmann::ordered_json;

constexpr const char* k_key = "mounted";
constexpr std::array k_parts{"tip", "payload", "table"};
constexpr double k_farthest_mm = 1000;  // as of a process's tip and centre of mass
constexpr double k_most_kg = 20;
constexpr double k_highest_mm = 5000;  // of a table, from the robot's base

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

Taught taught(const Record& before, const Hand& hand) {
  return {.version = before.version + 1, .who = hand.who, .time = memory::now_ms()};
}

}  // namespace

path::Mounted Record::mounted() const {
  path::Mounted out;
  if (tip) {
    out.tip_flange = tip->tip_flange;
    out.tip_u95_mm = tip->how.u95_mm;
  }
  if (payload) out.payload = payload->payload;
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

ordered_json to_json(const Record& record, Part part) {
  ordered_json json;
  switch (part) {
    case Part::Tip:
      if (!record.tip) return json;
      json["at_mm"] = list(record.tip->tip_flange);
      tell(record.tip->how, json);
      return json;
    case Part::Payload:
      if (!record.payload) return json;
      json["kg"] = record.payload->payload.mass_kg;
      json["centre_mm"] = list(record.payload->payload.centre_flange_mm);
      tell(record.payload->how, json);
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
  return {{"version", record.version},
          {"tip", to_json(record, Part::Tip)},
          {"payload", to_json(record, Part::Payload)},
          {"table", to_json(record, Part::Table)}};
}

Result<Record> read_record(const memory::Memory& memory) {
  BITELINE_ASSIGN(const std::optional<std::string> text, memory.setting(k_key));
  Record record;
  if (!text) return record;
  const ordered_json json = ordered_json::parse(*text, nullptr, false);
  bool good = json.is_object();
  // Null is not taught; of anything else nobody knows what was.
  for (const char* part : k_parts)
    good = good && json.contains(part) && (json[part].is_null() || json[part].is_object());
  if (good) {
    record.version = static_cast<int>(Reader{json, good}.number("version", 0, 1e9));
    if (const ordered_json& tip = json["tip"]; tip.is_object())
      record.tip = Tip{.tip_flange = Reader{tip, good}.vector("at_mm"), .how = Reader{tip, good}.how()};
    if (const ordered_json& load = json["payload"]; load.is_object())
      record.payload = Load{.payload = {.mass_kg = Reader{load, good}.number("kg", 0, k_most_kg),
                                        .centre_flange_mm = Reader{load, good}.vector("centre_mm")},
                            .how = Reader{load, good}.how()};
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

Result<Record> forget(memory::Memory& memory, Part part, const Hand& hand) {
  const Result<Record> read = read_record(memory);
  // One that cannot be read goes whole: it could never be taught again.  A memory that is busy costs nothing.
  if (!read && read.error().code != Errc::BadFormat) return tl::unexpected<Error>{read.error()};
  const Record before = read ? *read : Record{};
  Record now = before;
  if (part == Part::Tip) now.tip.reset();
  if (part == Part::Payload) now.payload.reset();
  if (part == Part::Table) now.table.reset();
  return keep(memory, before, std::move(now), part, hand, "forget what was taught");
}

}  // namespace biteline::mounted
