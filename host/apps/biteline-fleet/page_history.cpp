// SPDX-License-Identifier: MIT
// The centre's page: what was, by a filter: shoes, their trends, models at cells, the log.
#include "host/apps/biteline-fleet/page_api.hpp"
#include "host/fleet/overview.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/records/memory/history.hpp"

namespace biteline::fleet {

using api::ok;
using control::Answer;
using control::Json;
using control::Request;

namespace {

std::string query_text(const Request& request, const char* key) {
  const auto found = request.query.find(key);
  return found == request.query.end() ? std::string{} : found->second;
}

/// The cell's own filter, beside which the centre knows one more.
api::QueryFilter filter_of(const Request& request, const memory::FactoryDay& day) {
  std::map<std::string, std::string> query = request.query;
  query.erase("cell");
  return api::filter_of(query, day);
}

Json sums_json(const memory::Trend& sums) {
  return {{"scans", sums.scans},
          {"ok", sums.ok},
          {"amber", sums.amber},
          {"review", sums.review},
          {"refused", sums.refused},
          {"failed", sums.failed},
          {"length_mm", api::or_null(sums.mean_length_mm)},
          {"u95_mm", api::or_null(sums.median_u95_mm)},
          {"cycle_s", api::or_null(sums.median_cycle_s)}};
}

}  // namespace

Answer PageApi::list_fleet_scans(const Call& call) {
  const api::QueryFilter query = filter_of(call.request, rooms_.day);
  if (query.fault) return *query.fault;
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  const Result<FleetShoes> page = Overview{**here}.shoes(query_text(call.request, "cell"), query.filter);
  if (!page) return answer_of(page.error());
  Json scans = Json::array();
  for (const FleetShoe& shoe : page->shoes) {
    const memory::Scan& scan = shoe.scan;
    scans.push_back({{"cell", shoe.cell},
                     {"id", scan.name},
                     {"time", memory::to_iso(scan.time)},
                     {"verdict", scan.verdict},
                     {"decision", scan.decision},
                     {"model", api::or_null(scan.model)},
                     {"process", api::or_null(scan.process)},
                     {"part", api::or_null(scan.part)},
                     {"foot", api::or_null(scan.foot)},
                     {"size", api::or_null(scan.size)},
                     {"follows", api::or_null(scan.follows)},
                     {"work", api::work_json(scan.work)},
                     {"reason_code", api::or_null(scan.reason_code)},
                     {"reason", api::or_null(scan.reason)},
                     {"length_mm", api::or_null(scan.length_mm)},
                     {"confidence", api::or_null(scan.confidence)},
                     {"u95_mm", api::or_null(scan.u95_mm)},
                     {"cycle_s", api::or_null(scan.cycle_s)},
                     {"sent", scan.sent},
                     {"followed", scan.followed ? Json(*scan.followed) : Json{}},
                     {"release", api::or_null(shoe.release)}});
  }
  return ok({{"scans", std::move(scans)},
             {"next", page->next_id > 0 ? Json(std::to_string(page->next_id)) : Json{}}});
}

Answer PageApi::read_fleet_trends(const Call& call) {
  const api::QueryFilter query = filter_of(call.request, rooms_.day);
  if (query.fault) return *query.fault;
  const std::string asked = query_text(call.request, "bucket");
  const std::string bucket = asked.empty() ? "day" : asked;
  if (bucket != "hour" && bucket != "day" && bucket != "week")
    return control::refusal(400, "bad_request", "query bucket: hour, day or week expected");
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  const Result<memory::Trends> trends =
      Overview{**here}.trends(query_text(call.request, "cell"), query.filter, rooms_.day, bucket);
  return trends ? ok(memory::to_json(*trends)) : answer_of(trends.error());
}

Answer PageApi::list_groups(const Call& call) {
  const api::QueryFilter query = filter_of(call.request, rooms_.day);
  if (query.fault) return *query.fault;
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  const Result<std::vector<Group>> groups = Overview{**here}.groups(query.filter);
  if (!groups) return answer_of(groups.error());
  Json rows = Json::array();
  for (const Group& group : *groups) {
    Json row{{"cell", group.cell}, {"model", api::or_null(group.model)}};
    row.update(sums_json(group.sums));
    rows.push_back(std::move(row));
  }
  return ok({{"groups", std::move(rows)}});
}

Answer PageApi::read_log(const Call& call) {
  const api::QueryFilter query = filter_of(call.request, rooms_.day);
  if (query.fault) return *query.fault;
  const memory::ScanFilter& filter = query.filter;
  Result<std::vector<memory::LogRow>> rows =
      rooms_.memory.log_rows(filter.before_id, filter.limit + 1, filter.from, filter.to);
  if (!rows) return api::answer_of(rows.error());
  Json next;
  if (static_cast<int>(rows->size()) > filter.limit) {
    rows->pop_back();
    next = std::to_string(rows->back().id);
  }
  Json entries = Json::array();
  for (const memory::LogRow& row : *rows) entries.push_back(api::to_json(row));
  return ok({{"entries", std::move(entries)}, {"next", std::move(next)}});
}

}  // namespace biteline::fleet
