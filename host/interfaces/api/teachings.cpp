// SPDX-License-Identifier: MIT
// Teachings: who teaches what, and at which step it is.
#include <charconv>

#include "common/core/text_bounds.hpp"
#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"

namespace biteline::api {

using control::Answer;

namespace {

/// Of a teaching; nothing: it cannot be one.
std::optional<std::int64_t> teaching_number(const std::string& text) {
  std::int64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || at != end || number < 1) return std::nullopt;
  return number;
}

Answer no_such_teaching() {
  return control::refusal(404, "not_found", "no such teaching; GET /teachings lists them");
}

}  // namespace

Json Api::teaching_json() {
  const std::optional<memory::Teaching> open = teach_.look();
  if (!open) return nullptr;
  const std::optional<memory::TeachStep> step = memory::step_of(*open);
  return {{"id", open->id},
          {"step", step ? Json(memory::k_teach_steps.at(static_cast<std::size_t>(*step))) : Json{}}};
}

Answer Api::list_teachings(const Call& call) {
  const QueryFilter query = filter_of(call.request.query, rooms_.day);
  if (query.fault) return *query.fault;
  static_cast<void>(teach_.look());
  const int limit = query.filter.limit;
  Result<std::vector<memory::Teaching>> rows = rooms_.memory.teachings(query.filter.before_id, limit + 1);
  if (!rows) return answer_of(rows.error());
  Json next;
  if (static_cast<int>(rows->size()) > limit) {
    rows->pop_back();
    next = std::to_string(rows->back().id);
  }
  Json teachings = Json::array();
  for (const memory::Teaching& teaching : *rows) teachings.push_back(to_json(teaching));
  return ok({{"teachings", std::move(teachings)}, {"next", std::move(next)}});
}

Answer Api::read_teaching(const Call& call) {
  const std::optional<std::int64_t> id = teaching_number(call.names.front());
  if (!id) return no_such_teaching();
  const Result<std::optional<memory::Teaching>> teaching = teach_.look_at(*id);
  if (!teaching) return answer_of(teaching.error());
  return *teaching ? ok(to_json(**teaching)) : no_such_teaching();
}

Answer Api::give_up_teaching(const Call& call) {
  const std::optional<std::int64_t> id = teaching_number(call.names.front());
  if (!id) return no_such_teaching();
  const Result<std::optional<memory::Teaching>> teaching = teach_.look_at(*id);
  if (!teaching) return answer_of(teaching.error());
  if (!*teaching) return no_such_teaching();
  if (!teach_.give_up(*id, call.person.name))
    return control::refusal(409, "wrong_state", "teaching " + std::to_string(*id) + " has ended already");
  const Result<void> logged = rooms_.memory.log({.id = 0,
                                                 .time = memory::now_ms(),
                                                 .who = call.person.name,
                                                 .door = call.request.door,
                                                 .action = "give up teaching",
                                                 .subject = call.names.front(),
                                                 .before = {},
                                                 .after = {}});
  if (!logged) return answer_of(logged.error());
  return nothing();
}

Answer Api::see_dry_run(const Call& call) {
  Fields fields{call.request.body};
  const std::string scan = fields.text("scan", bounds::k_name);
  const std::optional<double> version = fields.number("line_version", 0, 1e6);
  const std::string process = fields.text("process_sha256", bounds::k_name);
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const std::optional<std::int64_t> id = teaching_number(call.names.front());
  if (!id) return no_such_teaching();
  const Result<memory::Teaching> seen =
      teach_.saw_dry_run(*id,
                         {.id = 0,
                          .time = memory::now_ms(),
                          .who = call.person.name,
                          .door = call.request.door,
                          .action = "look at dry run",
                          .subject = call.names.front(),
                          .before = {},
                          .after = scan},
                         [&](const memory::TaughtWork& work) {
                           return (scan.empty() || scan == work.scan) &&
                                  (!version || static_cast<int>(*version) == work.line_version) &&
                                  (process.empty() || process == work.process_sha256);
                         });
  if (!seen) return seen.error().code == Errc::FileNotFound ? no_such_teaching() : answer_of(seen.error());
  return ok(to_json(*seen));
}

}  // namespace biteline::api
