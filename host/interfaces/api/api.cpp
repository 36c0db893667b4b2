// SPDX-License-Identifier: MIT
// Routes, rights, sessions, control, state and commands.
#include "host/interfaces/api/api.hpp"

#include <sys/statvfs.h>

#include <array>
#include <string_view>

#include "common/core/text_bounds.hpp"
#include "host/interfaces/accounts/metrics_token.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/interfaces/api/people.hpp"
#include "host/interfaces/line_control/part_number.hpp"

namespace biteline::api {

using accounts::Person;
using accounts::Role;
using control::Answer;
using control::Request;

namespace {

constexpr const char* k_line = "/api/v1/line";

/// For the log: what was said of the next shoe.
std::string words_of_job(const Job& job) {
  std::string words;
  for (const std::string* text : {&job.model, &job.foot, &job.size, &job.part})
    if (!text->empty()) words += (words.empty() ? "" : ", ") + *text;
  return words;
}

}  // namespace

struct Api::Row : Route {
  Answer (Api::*answer)(const Call&);
};

std::span<const Api::Row> Api::rows() {
  static constexpr std::array k_rows{
#include "host/interfaces/api/service_routes.inc"
  };
  return k_rows;
}

Match<Api::Row> Api::find(const Request& request) {
  return find_route(rows(), request.method, request.path);
}

std::optional<Answer> Api::urgent(const Request& request) {
  // The line's heartbeat hangs on it, so it waits for no request of a page.
  if (request.method == "GET" && request.path == k_line) return read_line({.request = request, .person = {}});
  if (!control::is_stop(request)) return std::nullopt;
  if (request.path == control::k_line_stop_path) return stop_for_line({.request = request, .person = {}});
  const std::optional<Person> person = rooms_.accounts.known(request.token);
  if (!person && !request.local && !request.token.empty()) return std::nullopt;
  return halt(request, person);
}

bool Api::is_long(const Request& request) {
  // All that changes the library is in one line, and so is all that touches the exchange.
  const Match<Row> match = find(request);
  return match.route != nullptr && match.route->is_long;
}

Answer Api::halt(const Request& request, const std::optional<Person>& person) {
  if (!request.local && !person) return people::login_needed();
  if (!request.local && person->role < Role::Operator)
    return control::refusal(403, "not_allowed", "from another machine this needs an operator");
  const bool laser = request.path == control::k_laser_off_path;
  const std::string who = person ? person->name : "somebody at the cell";
  if (laser) {
    rooms_.cell.laser_off(who);
  } else {
    rooms_.cell.stop(who);
  }
  stop_log_.add({.id = 0,
                 .time = memory::now_ms(),
                 .who = who,
                 .door = request.door,
                 .action = laser ? "laser off" : "stop",
                 .subject = "cell",
                 .before = {},
                 .after = {}},
                person ? std::string{} : request.token);
  return ok(
      {{"done", true}, {"words", laser ? "the laser is told to be off" : "scan and arm are told to stop"}});
}

Answer Api::stop(const Call& call) {
  return halt(call.request, call.person.name.empty() ? std::nullopt : std::optional{call.person});
}
Answer Api::laser_off(const Call& call) {
  return stop(call);  // the path says which
}

Answer Api::ordinary(const Request& request) {
  // Of the libraries below (JSON, files): the request's fault or a defect, never the service's end.
  try {
    const Match<Row> match = find(request);
    Answer answer = dispatch(request, match);
    if (match.route != nullptr && match.route->changes && answer.status < 300 && rooms_.publish) {
      if (const auto rows = rooms_.memory.log_rows(0, 1); rows && !rows->empty())
        rooms_.publish("log", to_json(rows->front()));
    }
    return answer;
  } catch (const std::exception& error) {
    return control::refusal(500, "internal", std::string{"internal failure: "} + error.what());
  }
}

Answer Api::dispatch(const Request& request, const Match<Row>& match) {
  if (const std::optional<Answer> now = urgent(request)) return *now;
  if (match.route == nullptr && !match.methods.empty())
    return control::refusal(405, "method_not_allowed", "another method is expected at this path");
  if (match.route == nullptr) return control::refusal(404, "not_found", "no such path in /api/v1");
  const Row& row = *match.route;
  const Result<std::optional<Person>> person = rooms_.accounts.who_is(request.token);
  if (!person) return answer_of(person.error());
  if (row.role) {
    if (const std::optional<Answer> closed = people::closed_to(*person, *row.role)) return *closed;
  }
  if (row.control) {
    const std::optional<accounts::Holder> holder = rooms_.accounts.holder();
    if (!holder) return control::refusal(409, "control_needed", "take control first (POST /control)");
    if (holder->name != (*person)->name)
      return control::refusal(409, "control_held", holder->name + " holds control; ask for it or take it");
  }
  const Call call{.request = request, .person = person->value_or(Person{}), .names = match.names};
  return (this->*row.answer)(call);
}

Json Api::control_json() const {
  const std::optional<accounts::Holder> holder = rooms_.accounts.holder();
  if (!holder) return {{"holder", nullptr}};
  Json json{{"holder", holder->name}, {"door", holder->door}, {"since", memory::to_iso(holder->since)}};
  if (!holder->why.empty()) json["why"] = holder->why;
  return json;
}

Answer Api::read_state(const Call&) {
  Json state = rooms_.cell.state();
  state["control"] = control_json();
  state["teaching"] = teaching_json();
  state["seq"] = rooms_.last_seq ? rooms_.last_seq() : 0;
  return ok(std::move(state));
}

Answer Api::read_for_metrics(const Call& call) {
  // Also for a program that has a token for it.
  const Result<bool> may = accounts::may_read_metrics(rooms_.memory, rooms_.accounts, call.request.token);
  if (!may) return answer_of(may.error());
  if (!*may) return people::login_needed();
  return ok({{"state", rooms_.cell.state()}, {"sensors", list_sensors(call).body}});
}

Answer Api::log_in(const Call& call) {
  return people::log_in(rooms_.accounts, call.request);
}
Answer Api::log_out(const Call& call) {
  return people::log_out(rooms_.accounts, call.request);
}
Answer Api::read_me(const Call& call) {
  return people::read_me(rooms_.accounts, call.request, call.person);
}
Answer Api::list_users(const Call&) {
  return people::list_users(rooms_.accounts);
}
Answer Api::add_user(const Call& call) {
  return people::add_user(rooms_.accounts, call.request, call.person);
}
Answer Api::change_user(const Call& call) {
  return people::change_user(rooms_.accounts, call.request, call.person, call.names.front());
}
Answer Api::remove_user(const Call& call) {
  return people::remove_user(rooms_.accounts, call.request, call.person, call.names.front());
}

Answer Api::read_control(const Call&) {
  return ok(control_json());
}

Answer Api::change_control(const Call& call) {
  Fields fields{call.request.body};
  const std::string action = fields.text("action", 20, true);
  const std::string to = fields.text("to", bounds::k_name);
  const std::string why = fields.text("why", bounds::k_why);
  if (action != "take" && action != "give" && action != "release")
    fields.fault("action", "take, give or release expected");
  if (action == "give" && to.empty()) fields.fault("to", "a user's name expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  Result<void> done{};
  if (action == "take") done = rooms_.accounts.take_control(call.person.name, call.request.door, why);
  if (action == "give") done = rooms_.accounts.give_control(call.person.name, to, call.request.door);
  if (action == "release") done = rooms_.accounts.release_control(call.person.name, call.request.door);
  if (!done) return answer_of(done.error());
  if (rooms_.publish) rooms_.publish("control", control_json());
  return ok(control_json());
}

Answer Api::start(const Call& call) {
  Fields fields{call.request.body};
  const std::string model = fields.text("model", bounds::k_name),
                    process = fields.text("process", bounds::k_name);
  const std::optional<std::string> part =
      line_control::part_number(fields.text("part", line_control::k_most_part_bytes));
  const Job job{.model = model,
                .process = process,
                .foot = fields.text("foot", bounds::k_choice),
                .size = fields.text("size", bounds::k_size),
                .part = part.value_or(""),
                .keep_process = !fields.has("process") && model.empty(),
                .hold = fields.boolean("hold").value_or(false)};
  if (!job.model.empty() && !is_name(job.model)) fields.fault("model", "a model's name expected");
  if (!job.process.empty() && !is_name(job.process)) fields.fault("process", "a process's name expected");
  if (!job.foot.empty() && !is_foot(job.foot)) fields.fault("foot", "left or right expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (!job.process.empty()) {
    const Result<Catalogue> catalogue = this->catalogue();
    if (!catalogue) return answer_of(catalogue.error());
    if (const auto found = catalogue->processes.find(job.process); !found) return answer_of(found.error());
  }
  const memory::UnixMs heard = memory::now_ms();
  const Result<void> done = rooms_.cell.start(job, speaker(call));
  if (!done) return answer_of(done.error());
  if (job.hold) {
    teach_.begin(call.person.name, heard);
  } else {
    teach_.give_up(call.person.name);
  }
  static_cast<void>(rooms_.memory.log({.id = 0,
                                       .time = memory::now_ms(),
                                       .who = call.person.name,
                                       .door = call.request.door,
                                       .action = "start",
                                       .subject = "cell",
                                       .before = {},
                                       .after = words_of_job(job)}));
  return ok({{"done", false}, {"words", "the next scan is asked for as soon as the sensor is free"}}, 202);
}

Answer Api::rescan(const Call& call) {
  Fields fields{call.request.body};
  const std::string why = fields.text("why", bounds::k_why);
  const bool hold = fields.boolean("hold").value_or(false);
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const memory::UnixMs heard = memory::now_ms();
  // The scan that waits is rejected with it: what was taught of it is looked at before.
  static_cast<void>(teach_.look());
  const Result<void> done = rooms_.cell.rescan({.who = call.person.name,
                                                .why = why,
                                                .door = call.request.door,
                                                .hold = hold,
                                                .stops = call.request.stops});
  if (!done) return answer_of(done.error());
  if (hold) {
    teach_.begin_or_go_on(call.person.name, heard);
  } else {
    teach_.give_up(call.person.name);
  }
  static_cast<void>(rooms_.memory.log({.id = 0,
                                       .time = memory::now_ms(),
                                       .who = call.person.name,
                                       .door = call.request.door,
                                       .action = "rescan",
                                       .subject = "cell",
                                       .before = {},
                                       .after = why}));
  return ok({{"done", false}, {"words", "the shoe is scanned again"}}, 202);
}

Answer Api::list_robots(const Call&) {
  return ok({{"robots", rooms_.cell.robots()}});
}

Answer Api::list_sensors(const Call&) {
  struct statvfs disk {};
  Json free{{"free_bytes", 0}, {"total_bytes", 0}};
  if (::statvfs(rooms_.results.c_str(), &disk) == 0) {
    free = {{"free_bytes", std::uint64_t{disk.f_bavail} * disk.f_frsize},
            {"total_bytes", std::uint64_t{disk.f_blocks} * disk.f_frsize}};
  }
  return ok({{"sensors", rooms_.cell.sensors()}, {"disk", free}});
}

}  // namespace biteline::api
