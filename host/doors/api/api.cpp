// SPDX-License-Identifier: MIT
// Routes, rights, sessions, control, state and commands.
#include "host/doors/api/api.hpp"

#include <sys/statvfs.h>

#include <algorithm>
#include <string_view>

#include "common/core/text_bounds.hpp"
#include "host/doors/accounts/metrics_token.hpp"
#include "host/doors/api/people.hpp"
#include "host/doors/api/words.hpp"

namespace biteline::api {

using accounts::Person;
using accounts::Role;
using control::Answer;
using control::Request;

namespace {

constexpr std::string_view k_root = "/api/v1";
constexpr std::string_view k_for_metrics = "/api/v1/exchange/metrics";
constexpr const char* k_line = "/api/v1/line";
constexpr const char* k_check_process = "/api/v1/processes/check";  // changes nothing: no log row
constexpr const char* k_touches = "/api/v1/mounted/touches";        // nor does this

/// The parts of `path` that stand where `pattern` has "{}"; nothing when they do not fit.
std::optional<std::vector<std::string>> match(std::string_view pattern, std::string_view path) {
  std::vector<std::string> names;
  while (!pattern.empty() || !path.empty()) {
    if (pattern.empty() || path.empty() || pattern.front() != '/' || path.front() != '/') return std::nullopt;
    pattern.remove_prefix(1);
    path.remove_prefix(1);
    const std::string_view wanted = pattern.substr(0, pattern.find('/'));
    const std::string_view got = path.substr(0, path.find('/'));
    if (wanted == "{}") {
      if (got.empty()) return std::nullopt;
      names.emplace_back(got);
    } else if (wanted != got) {
      return std::nullopt;
    }
    pattern.remove_prefix(wanted.size());
    path.remove_prefix(got.size());
  }
  return names;
}

}  // namespace

struct Api::Route {
  const char* method;
  const char* path;
  std::optional<Role> role;  ///< nothing: nobody need be logged in
  bool control;
  Answer (Api::*answer)(const Call&);
};

std::vector<Api::Route> Api::routes() {
  using enum Role;
  return {
      {"GET", "/state", Viewer, false, &Api::read_state},
      {"POST", "/sessions", std::nullopt, false, &Api::log_in},
      {"DELETE", "/sessions", Viewer, false, &Api::log_out},
      {"GET", "/me", Viewer, false, &Api::read_me},
      {"GET", "/control", Viewer, false, &Api::read_control},
      {"POST", "/control", Operator, false, &Api::change_control},
      {"GET", "/scans", Viewer, false, &Api::list_scans},
      {"GET", "/scans/{}", Viewer, false, &Api::read_scan},
      {"POST", "/scans/{}/accept", Operator, true, &Api::accept},
      {"POST", "/scans/{}/reject", Operator, true, &Api::reject},
      {"POST", "/scans/{}/send", Operator, true, &Api::send},
      {"POST", "/scans/{}/hold", Operator, true, &Api::hold},
      {"POST", "/scans/{}/model", Operator, true, &Api::choose_model},
      {"POST", "/scans/{}/process", Engineer, true, &Api::choose_process},
      {"POST", "/scans/{}/air", Operator, true, &Api::run_in_air},
      {"POST", "/scans/{}/mend", Operator, true, &Api::mend},
      {"POST", "/scans/{}/rerun", Engineer, true, &Api::rerun},
      {"POST", "/scans/{}/keep", Operator, false, &Api::keep},
      {"POST", "/commands/start", Operator, true, &Api::start},
      {"POST", "/commands/rescan", Operator, true, &Api::rescan},
      {"GET", "/models", Viewer, false, &Api::list_models},
      {"POST", "/models", Engineer, false, &Api::save_model},
      {"GET", "/models/{}", Viewer, false, &Api::read_model},
      {"DELETE", "/models/{}", Engineer, false, &Api::remove_model},
      {"GET", "/models/{}/file", Viewer, false, &Api::export_model},
      // Between programs: biteline-web brings the body of POST /model-files in pieces.
      {"POST", "/exchange/model", Engineer, true, &Api::import_model},
      {"DELETE", "/exchange/model", Engineer, false, &Api::drop_import},
      {"GET", "/processes", Viewer, false, &Api::list_processes},
      {"GET", "/processes/schema", Viewer, false, &Api::read_process_schema},
      {"POST", "/processes/check", Engineer, false, &Api::check_process},
      {"GET", "/processes/{}", Viewer, false, &Api::read_process},
      {"PUT", "/processes/{}", Engineer, false, &Api::write_process},
      {"GET", "/mounted", Viewer, false, &Api::read_mounted},
      {"POST", "/mounted/touches", Engineer, true, &Api::touch},
      {"DELETE", "/mounted/touches", Engineer, true, &Api::end_lesson},
      {"PUT", "/mounted/{}", Engineer, true, &Api::keep_mounted},
      {"DELETE", "/mounted/{}", Engineer, true, &Api::forget_mounted},
      {"GET", "/robots", Viewer, false, &Api::list_robots},
      {"GET", "/sensors", Viewer, false, &Api::list_sensors},
      {"PATCH", "/sensors/settings", Engineer, true, &Api::change_settings},
      {"POST", "/sensors/keep", Operator, true, &Api::keep_recording},
      {"GET", "/users", Administrator, false, &Api::list_users},
      // The first account is made by whoever sits at the cell's own machine: add_user() sees to it.
      {"POST", "/users", std::nullopt, false, &Api::add_user},
      {"PATCH", "/users/{}", Viewer, false, &Api::change_user},
      {"DELETE", "/users/{}", Administrator, false, &Api::remove_user},
      // The line's control has no login: closed_to_line() sees who asks.
      {"GET", "/line", std::nullopt, false, &Api::read_line},
      {"PUT", "/line/job", std::nullopt, false, &Api::choose_job},
      {"POST", "/line/start", std::nullopt, false, &Api::start_for_line},
      {"GET", "/log", Engineer, false, &Api::read_log},
      {"GET", "/history/trends", Viewer, false, &Api::read_trends},
      {"GET", "/history.csv", Viewer, false, &Api::export_history},
  };
}

std::optional<Answer> Api::urgent(const Request& request) {
  // The line's heartbeat hangs on it, so it waits for no request of a page.
  if (request.method == "GET" && request.path == k_line) return read_line({.request = request, .person = {}});
  if (!control::is_stop(request)) return std::nullopt;
  if (request.path == control::k_line_stop_path) return stop_for_line(request);
  const std::optional<Person> person = rooms_.accounts.known(request.token);
  if (!person && !request.local && !request.token.empty()) return std::nullopt;
  return stop(request, person);
}

bool Api::is_long(const Request& request) {
  // A Prometheus that looks waits for no file and no arm.
  if (!request.path.starts_with(k_root) || request.path == k_for_metrics) return false;
  const std::string_view path = std::string_view{request.path}.substr(k_root.size());
  const auto below = [path](std::string_view folder) {
    return path.starts_with(folder) && (path.size() == folder.size() || path[folder.size()] == '/');
  };
  // All that changes the library is in one line, and so is all that touches the exchange.
  return below("/exchange") || below("/models") || below("/mounted") || path == "/sensors/settings" ||
         path == "/sensors/keep" || path == "/processes/check";
}

Answer Api::stop(const Request& request, const std::optional<Person>& person) {
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

Answer Api::ordinary(const Request& request) {
  // Of the libraries below (JSON, files): the request's fault or a defect, never the service's end.
  try {
    Answer answer = dispatch(request);
    const bool changed =
        request.method != "GET" && request.path != k_check_process && request.path != k_touches;
    if (changed && answer.status < 300 && rooms_.publish) {
      if (const auto rows = rooms_.memory.log_rows(0, 1); rows && !rows->empty())
        rooms_.publish("log", to_json(rows->front()));
    }
    return answer;
  } catch (const std::exception& error) {
    return control::refusal(500, "internal", std::string{"internal failure: "} + error.what());
  }
}

Answer Api::dispatch(const Request& request) {
  if (const std::optional<Answer> now = urgent(request)) return *now;
  if (control::is_stop(request)) {
    const Result<std::optional<Person>> person = rooms_.accounts.who_is(request.token);
    if (!person) return answer_of(person.error());
    return stop(request, *person);
  }
  if (!request.path.starts_with(k_root))
    return control::refusal(404, "not_found", "no such path; the API begins with /api/v1");
  // Between programs: what biteline-web makes its /metrics of, also for a program that has a token for it.
  if (request.method == "GET" && request.path == k_for_metrics) {
    const Result<bool> may = accounts::may_read_metrics(rooms_.memory, rooms_.accounts, request.token);
    if (!may) return answer_of(may.error());
    if (!*may) return people::login_needed();
    const Call call{.request = request, .person = {}, .names = {}};
    return ok({{"state", rooms_.cell.state()}, {"sensors", list_sensors(call).body}});
  }
  const std::string_view path = std::string_view{request.path}.substr(k_root.size());
  static const std::vector<Route> k_routes = routes();
  bool other_method = false;
  for (const Route& route : k_routes) {
    std::optional<std::vector<std::string>> names = match(route.path, path);
    if (!names) continue;
    if (request.method != route.method) {
      other_method = true;
      continue;
    }
    const Result<std::optional<Person>> person = rooms_.accounts.who_is(request.token);
    if (!person) return answer_of(person.error());
    if (route.role) {
      if (const std::optional<Answer> closed = people::closed_to(*person, *route.role)) return *closed;
    }
    if (route.control) {
      const std::optional<accounts::Holder> holder = rooms_.accounts.holder();
      if (!holder) return control::refusal(409, "control_needed", "take control first (POST /control)");
      if (holder->name != (*person)->name)
        return control::refusal(409, "control_held", holder->name + " holds control; ask for it or take it");
    }
    const Call call{.request = request, .person = person->value_or(Person{}), .names = std::move(*names)};
    return (this->*route.answer)(call);
  }
  if (other_method)
    return control::refusal(405, "method_not_allowed", "another method is expected at this path");
  return control::refusal(404, "not_found", "no such path in /api/v1");
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
  state["seq"] = rooms_.last_seq ? rooms_.last_seq() : 0;
  return ok(std::move(state));
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
  const Job job{.model = model,
                .process = process,
                .keep_process = !fields.has("process") && model.empty(),
                .hold = fields.boolean("hold").value_or(false)};
  if (!job.model.empty() && !is_name(job.model)) fields.fault("model", "a model's name expected");
  if (!job.process.empty() && !is_name(job.process)) fields.fault("process", "a process's name expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (!job.process.empty()) {
    const Result<Stock> stock = this->stock();
    if (!stock) return answer_of(stock.error());
    if (const auto found = stock->processes.find(job.process); !found) return answer_of(found.error());
  }
  const Result<void> done = rooms_.cell.start(job, speaker(call));
  if (!done) return answer_of(done.error());
  static_cast<void>(rooms_.memory.log({.id = 0,
                                       .time = memory::now_ms(),
                                       .who = call.person.name,
                                       .door = call.request.door,
                                       .action = "start",
                                       .subject = "cell",
                                       .before = {},
                                       .after = job.model}));
  return ok({{"done", false}, {"words", "the next scan is asked for as soon as the sensor is free"}}, 202);
}

Answer Api::rescan(const Call& call) {
  Fields fields{call.request.body};
  const std::string why = fields.text("why", bounds::k_why);
  const bool hold = fields.boolean("hold").value_or(false);
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Result<void> done = rooms_.cell.rescan({.who = call.person.name,
                                                .why = why,
                                                .door = call.request.door,
                                                .hold = hold,
                                                .stops = call.request.stops});
  if (!done) return answer_of(done.error());
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
