// SPDX-License-Identifier: MIT
// The line's control: a PLC or a robot without a login, through doors of its own.
#include <cstdint>

#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/interfaces/line_control/part_number.hpp"

namespace biteline::api {

using control::Answer;
using line_control::Refusal;

namespace {

/// Doors of biteline-web that are no page (--modbus, --text); a page's requests all come from "web".
bool is_line_door(const std::string& door) {
  return door == "modbus" || door == "text";
}

/// A refusal is an answer like any other: the door tells its number.
Answer line_answer(Refusal refusal) {
  return ok({{"refusal", static_cast<int>(refusal)}, {"words", line_control::words_of(refusal)}});
}

/// The field `name` as a whole number from 0 to 65535; it alone may stand in the body.
std::optional<int> one_number(const Json& body, const char* name) {
  if (!body.is_object() || body.size() != 1) return std::nullopt;
  const auto found = body.find(name);
  if (found == body.end() || !found->is_number_integer()) return std::nullopt;
  const auto number = found->get<std::int64_t>();
  if (number < 0 || number > 65535) return std::nullopt;
  return static_cast<int>(number);
}

memory::LogRow line_event(const std::string& door, const char* action, const std::string& after) {
  return {.id = 0,
          .time = memory::now_ms(),
          .who = "the line's control",
          .door = door,
          .action = action,
          .subject = "cell",
          .before = {},
          .after = after};
}

}  // namespace

std::optional<Answer> Api::closed_to_line(const Call& call) {
  if (!is_line_door(call.request.door))
    return control::refusal(404, "not_found", "this path is for --modbus and --text of biteline-web alone");
  if (!rooms_.cell.on_demand()) return line_answer(Refusal::NotOpen);
  return std::nullopt;
}

Answer Api::stop_for_line(const Call& call) {
  if (!is_line_door(call.request.door))
    return control::refusal(404, "not_found", "this path is for --modbus and --text of biteline-web alone");
  // Whoever may start may stop, also where scans are not for the line's control to start, and without a
  // token.
  rooms_.cell.stop("the line's control");
  stop_log_.add(line_event(call.request.door, "stop", ""));
  return line_answer(Refusal::None);
}

std::optional<Answer> Api::closed_to_commands(const Call& call) {
  if (std::optional<Answer> closed = closed_to_line(call)) return closed;
  if (rooms_.line_token.empty() || call.request.token == rooms_.line_token) return std::nullopt;
  return control::refusal(
      403, "not_allowed",
      "no door of the line's control: biteline-web reads its token in the results' folder");
}

Answer Api::read_line(const Call& call) {
  if (std::optional<Answer> closed = closed_to_line(call)) return *closed;
  return ok(line_control::to_json(rooms_.cell.line_state()));
}

Answer Api::choose_job(const Call& call) {
  if (std::optional<Answer> closed = closed_to_commands(call)) return *closed;
  const std::optional<int> number = one_number(call.request.body, "job");
  if (!number) return line_answer(Refusal::BadRequest);
  const std::optional<Job> job = rooms_.cell.job_of(*number);
  if (!job) return line_answer(Refusal::UnknownJob);
  const Result<Catalogue> catalogue = this->catalogue();
  std::error_code error;
  const bool model_gone = catalogue && !job->model.empty() &&
                          !std::filesystem::is_directory(catalogue->models.path_of(job->model), error);
  if (!catalogue || model_gone || (!job->process.empty() && !catalogue->processes.find(job->process)))
    return line_answer(Refusal::UnknownJob);
  const int before = rooms_.cell.line_state().job;
  const Refusal refusal = rooms_.cell.choose_job(*number, rooms_.accounts.holder().has_value());
  // A control that says its job again each second fills no log.
  if (refusal == Refusal::None && before != *number) {
    static_cast<void>(
        rooms_.memory.log(line_event(call.request.door, "job chosen", std::to_string(*number))));
  }
  return line_answer(refusal);
}

Answer Api::choose_part(const Call& call) {
  if (std::optional<Answer> closed = closed_to_commands(call)) return *closed;
  const Json& body = call.request.body;
  const bool sound =
      body.is_object() && body.size() == 1 && body.contains("part") && body["part"].is_string();
  const std::optional<std::string> part =
      sound ? line_control::part_number(body["part"].get<std::string>()) : std::nullopt;
  if (!part) return line_answer(Refusal::BadRequest);
  const std::string before = rooms_.cell.line_state().next_part;
  const Refusal refusal = rooms_.cell.choose_part(*part, rooms_.accounts.holder().has_value());
  // As of a job: one that is said again and again fills no log.
  if (refusal == Refusal::None && before != *part)
    static_cast<void>(rooms_.memory.log(line_event(call.request.door, "part chosen", *part)));
  return line_answer(refusal);
}

Answer Api::start_for_line(const Call& call) {
  if (std::optional<Answer> closed = closed_to_commands(call)) return *closed;
  const std::optional<int> request = one_number(call.request.body, "request");
  if (!request) return line_answer(Refusal::BadRequest);
  const Cell::LineStart start =
      rooms_.cell.start_for_line(*request, rooms_.accounts.holder().has_value(), call.request.stops);
  if (start.fresh) {
    // Its scans are held no more.
    if (start.refusal == Refusal::None) teach_.give_up("the line's control");
    static_cast<void>(rooms_.memory.log(line_event(call.request.door, "start", std::to_string(*request))));
  }
  return line_answer(start.refusal);
}

}  // namespace biteline::api
