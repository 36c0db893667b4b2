// SPDX-License-Identifier: MIT
#include "host/interfaces/api/mounted.hpp"

#include <cmath>

#include "common/core/fixed_text.hpp"
#include "common/core/text_bounds.hpp"
#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/records/force_book/tool_wear.hpp"
#include "host/records/mounted/mounted_record.hpp"

namespace biteline::api {

using control::Answer;
using Lesson = kinematics::TouchLesson;

namespace {

/// A person takes the hand off the arm no sooner.
constexpr std::chrono::seconds k_latest_touch{2};
/// Of a controller's standard digital inputs and outputs.
constexpr double k_last_line = 7;

Json list(const Vec3& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Answer no_such_part() {
  return control::refusal(404, "not_found", "tip, payload, lines, renewed or table expected");
}

/// By the tools' names, of those that have pressed a shoe.
Json wear_json(const mounted::Record& record, std::span<const force_book::Entry> pressed) {
  Json json = Json::object();
  const auto add = [&](const std::string& tool, const std::optional<mounted::Taught>& renewed) {
    const force_book::ToolWear wear = force_book::wear_of_tool(pressed, tool, renewed ? renewed->time : 0);
    if (wear.shoes > 0) json[tool] = force_book::to_json(wear);
  };
  if (record.tool) add(record.tool->name, record.renewed);
  for (const auto& [name, taught] : record.shelf) add(name, taught.renewed);
  return json;
}

/// What the controller said, beside what was taught.
Json look_json(const std::optional<robot::ur::ArmLook>& look, const mounted::Record& record) {
  if (!look) return nullptr;
  Json json{{"tip_mm", list(look->tip_flange)},
            {"payload_kg", nullptr},
            {"payload_centre_mm", nullptr},
            {"carries_as_taught", nullptr}};
  if (!look->payload) return json;
  json["payload_kg"] = look->payload->mass_kg;
  json["payload_centre_mm"] = list(look->payload->centre_flange_mm);
  path::Process carried;
  carried.tool.payload = look->payload;
  if (const std::optional<bool> same = path::carries_as_taught(carried, record.mounted({})))
    json["carries_as_taught"] = *same;
  return json;
}

}  // namespace

Json MountedRoom::lesson_json() const {
  if (lesson_.touches() == 0) return nullptr;
  Json json{{"part", lesson_.part() == Lesson::Part::Tip ? "tip" : "table"},
            {"touches", lesson_.touches()},
            {"at_mm", nullptr},
            {"z_mm", nullptr},
            {"residual_mm", nullptr},
            {"u95_mm", nullptr},
            {"missing", nullptr}};
  const Result<kinematics::Touched> outcome = lesson_.outcome();
  if (!outcome) {
    json["missing"] = to_line(outcome.error());
    return json;
  }
  if (lesson_.part() == Lesson::Part::Tip) {
    json["at_mm"] = list(outcome->tip_flange);
  } else {
    json["z_mm"] = outcome->z_mm;
  }
  json["residual_mm"] = outcome->residual_mm;
  json["u95_mm"] = outcome->u95_mm;
  return json;
}

Answer MountedRoom::read() {
  const Result<mounted::Record> record = mounted::read_record(memory_);
  if (!record) return answer_of(record.error());
  Json json = mounted::to_json(*record);
  json["lesson"] = lesson_json();
  json["controller"] = look_json(look_, *record);
  const Result<std::vector<force_book::Entry>> pressed = force_book::read_all(memory_);
  if (!pressed) return answer_of(pressed.error());
  json["wear"] = wear_json(*record, *pressed);
  return ok(std::move(json));
}

Answer MountedRoom::touch(const Json& body, std::chrono::steady_clock::time_point heard) {
  Fields fields{body};
  const std::string part = fields.text("part", 10, true);
  const bool take_back = fields.boolean("take_back").value_or(false);
  if (part != "tip" && part != "table") fields.fault("part", "tip or table expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Lesson::Part wanted = part == "tip" ? Lesson::Part::Tip : Lesson::Part::Table;
  const bool other = lesson_.touches() == 0 || lesson_.part() != wanted;
  if (take_back) {
    if (!other) lesson_.take_back();
    return read();
  }
  const Result<mounted::Record> record = mounted::read_record(memory_);
  if (!record) return answer_of(record.error());
  if (wanted == Lesson::Part::Table && !record->tip)
    return control::refusal(409, "wrong_state", "teach the tip first: it is what touches the table");
  const Result<robot::ur::ArmLook> look = cell_.look_at_arm();
  if (!look) {
    Answer told = answer_of(look.error());
    // An arm that does not answer is no failure of this program.
    if (told.status == 500) {
      told = control::refusal(409, "wrong_state",
                              "the arm does not answer (" + to_line(look.error()) +
                                  "); see to its power and its network, then touch again");
    }
    return told;
  }
  look_ = *look;
  // Others' work may have come first, and the arm may have gone on since the person said "it touches".
  const std::chrono::duration<double> late = std::chrono::steady_clock::now() - heard;
  if (late > k_latest_touch) {
    return control::refusal(
        409, "wrong_state",
        FixedText<160>::format("the arm could be asked only %.1f s after the touch, and may "
                               "have moved by then; touch again",
                               late.count())
            .c_str());
  }
  if (other) lesson_.begin(wanted, record->tip ? record->tip->tip_flange : Vec3{Vec3::Zero()});
  if (const Result<void> added = lesson_.add(look->T_base_flange); !added) return answer_of(added.error());
  return read();
}

Answer MountedRoom::end_lesson() {
  lesson_.end();
  return read();
}

Answer MountedRoom::keep(const std::string& part, const Json& body, const std::string& who,
                         const std::string& door) {
  const mounted::Hand hand{.who = who, .door = door};
  Fields fields{body};
  if (part == "payload") {
    constexpr double k_most_kg = 20, k_farthest_mm = 1000;
    const std::optional<double> kg = fields.number("kg", 0, k_most_kg);
    const Json given = fields.list("centre_mm", 3);
    bool numbers = given.size() == 3;
    path::Payload payload{.mass_kg = kg.value_or(0)};
    for (std::size_t i = 0; numbers && i < 3; ++i) {
      numbers = given[i].is_number();
      if (numbers) payload.centre_flange_mm[static_cast<Eigen::Index>(i)] = given[i].get<double>();
    }
    if (!kg) fields.fault("kg", "0 to 20 kg expected");
    if (!numbers || !(payload.centre_flange_mm.norm() <= k_farthest_mm))
      fields.fault("centre_mm", "three numbers within 1000 mm of the flange expected");
    if (const std::optional<Answer> faults = fields.faults()) return *faults;
    if (const auto kept = mounted::keep_payload(memory_, payload, hand); !kept)
      return answer_of(kept.error());
    // To compare with; a controller that is away costs only that.
    const Result<robot::ur::ArmLook> look = cell_.look_at_arm();
    look_ = look ? std::optional{*look} : std::nullopt;
    return read();
  }
  if (part == "lines") return keep_lines(fields, hand);
  if (part == "renewed") {
    if (const std::optional<Answer> faults = fields.faults()) return *faults;
    const auto kept = mounted::renew_tool(memory_, hand);
    return kept ? read() : answer_of(kept.error());
  }
  if (part != "tip" && part != "table") return no_such_part();
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Lesson::Part wanted = part == "tip" ? Lesson::Part::Tip : Lesson::Part::Table;
  if (lesson_.touches() == 0 || lesson_.part() != wanted)
    return control::refusal(409, "wrong_state", "nothing was touched yet; touch first");
  const Result<kinematics::Touched> touched = lesson_.outcome();
  if (!touched) return control::refusal(409, "wrong_state", to_line(touched.error()));
  const auto kept = mounted::keep_touched(memory_, wanted, *touched, lesson_.touches(), hand);
  if (!kept) return answer_of(kept.error());
  lesson_.end();
  return read();
}

Answer MountedRoom::keep_lines(Fields& fields, const mounted::Hand& hand) {
  const auto line = [&](const char* name) -> std::optional<int> {
    const std::optional<double> number = fields.number(name, 0, k_last_line);
    if (!number) return std::nullopt;
    if (std::floor(*number) != *number) fields.fault(name, "a whole number expected");
    return static_cast<int>(*number);
  };
  const std::optional<int> ask_output = line("ask_output"), there_input = line("there_input");
  path::ToolLines lines{.on_output = line("on_output"), .changer = {}};
  if (ask_output && there_input)
    lines.changer = path::ChangerLines{.ask_output = *ask_output, .there_input = *there_input};
  else if (ask_output || there_input)
    fields.fault(ask_output ? "there_input" : "ask_output",
                 "a changer's place has an output that asks for it and an input that tells");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const auto kept = mounted::keep_lines(memory_, lines, hand);
  return kept ? read() : answer_of(kept.error());
}

Answer MountedRoom::mount(const Json& body, const std::string& who, const std::string& door) {
  Fields fields{body};
  const std::string tool = fields.text("name", bounds::k_name, true);
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const auto kept = mounted::mount_tool(memory_, tool, {.who = who, .door = door});
  if (!kept) return answer_of(kept.error());
  // Touches of the tool before are none of this one.
  lesson_.end();
  cell_.tool_mounted();
  return read();
}

Answer MountedRoom::forget(const std::string& part, const std::string& who, const std::string& door) {
  const std::optional<mounted::Part> which = mounted::part_of(part);
  if (!which) return no_such_part();
  const auto kept = mounted::forget(memory_, *which, {.who = who, .door = door});
  // A table is not touched with a tip that nobody knows any more.
  if (kept && *which == mounted::Part::Tip && lesson_.part() == Lesson::Part::Table) lesson_.end();
  if (kept && *which == mounted::Part::Tool) cell_.tool_mounted();
  return kept ? read() : answer_of(kept.error());
}

Answer Api::read_mounted(const Call&) {
  return mounted_.read();
}
Answer Api::touch(const Call& call) {
  return mounted_.touch(call.request.body, call.request.heard);
}
Answer Api::end_lesson(const Call&) {
  return mounted_.end_lesson();
}
Answer Api::keep_mounted(const Call& call) {
  return mounted_.keep(call.names.front(), call.request.body, call.person.name, call.request.door);
}
Answer Api::mount_tool(const Call& call) {
  return mounted_.mount(call.request.body, call.person.name, call.request.door);
}
Answer Api::forget_tool(const Call& call) {
  return mounted_.forget("tool", call.person.name, call.request.door);
}
Answer Api::forget_mounted(const Call& call) {
  return mounted_.forget(call.names.front(), call.person.name, call.request.door);
}

}  // namespace biteline::api
