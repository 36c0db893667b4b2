// SPDX-License-Identifier: MIT
// The centre's page: recordings that are asked for, and those that stay.
#include "host/apps/biteline-fleet/page_api.hpp"
#include "host/fleet/recording_messages.hpp"
#include "host/fleet/recordings.hpp"
#include "host/interfaces/api/json_fields.hpp"

namespace biteline::fleet {

using api::ok;
using control::Answer;
using control::Json;

namespace {

struct NamedScan {
  std::string cell, scan;
};

NamedScan named_in(api::Fields& fields) {
  NamedScan named{.cell = fields.text("cell", 64, true), .scan = fields.text("scan", 64, true)};
  if (!named.cell.empty() && !is_cell_name(named.cell)) fields.fault("cell", "a cell's name expected");
  if (!named.scan.empty() && !is_scan_folder(named.scan)) fields.fault("scan", "a scan's name expected");
  return named;
}

Json fetch_json(const FetchRow& row) {
  return {{"number", row.number}, {"cell", row.cell},
          {"scan", row.scan},     {"state", to_text(row.state)},
          {"have", row.have},     {"total", row.total},
          {"marked", row.marked}, {"words", api::or_null(row.words)}};
}

}  // namespace

void PageApi::log(const Call& call, const char* action, const std::string& subject) const {
  static_cast<void>(rooms_.memory.log({.id = 0,
                                       .time = memory::now_ms(),
                                       .who = call.person.name,
                                       .door = call.request.door,
                                       .action = action,
                                       .subject = subject,
                                       .before = {},
                                       .after = {}}));
}

Answer PageApi::list_fetches(const Call&) {
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  const Result<std::vector<FetchRow>> fetches = Recordings{**here}.list();
  if (!fetches) return answer_of(fetches.error());
  Json rows = Json::array();
  for (const FetchRow& row : *fetches) rows.push_back(fetch_json(row));
  return ok({{"fetches", std::move(rows)}});
}

Answer PageApi::fetch_recording(const Call& call) {
  api::Fields fields{call.request.body};
  const NamedScan named = named_in(fields);
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  Recordings recordings{**here};
  const Result<std::int64_t> number = recordings.ask(named.cell, named.scan);
  if (!number) return answer_of(number.error());
  const Result<FetchRow> row = recordings.row(*number);
  if (!row) return answer_of(row.error());
  log(call, "fetch recording", named.cell + "/" + named.scan);
  return ok(fetch_json(*row), 202);
}

Answer PageApi::keep_fetched_recording(const Call& call) {
  api::Fields fields{call.request.body};
  const NamedScan named = named_in(fields);
  const std::optional<bool> marked = fields.boolean("marked");
  if (!marked) fields.fault("marked", "true or false expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  if (const Result<void> done = Recordings{**here}.mark(named.cell, named.scan, *marked); !done)
    return answer_of(done.error());
  log(call, *marked ? "keep recording" : "let recording go", named.cell + "/" + named.scan);
  return ok({{"cell", named.cell}, {"scan", named.scan}, {"marked", *marked}});
}

}  // namespace biteline::fleet
