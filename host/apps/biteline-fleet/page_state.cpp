// SPDX-License-Identifier: MIT
// The centre's page: what is: the centre itself, its cells, what needs somebody, releases.
#include "host/apps/biteline-fleet/page_api.hpp"
#include "host/fleet/alarms.hpp"
#include "host/fleet/releases.hpp"
#include "host/interfaces/accounts/metrics_token.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/interfaces/api/people.hpp"

namespace biteline::fleet {

using api::ok;
using control::Answer;
using control::Json;

Answer PageApi::read_state(const Call&) {
  Result<Centre*> here = centre();
  // One that went away is noticed by asking; not for what counts all shoes, since every page asks each 5 s.
  if (here && !(*here)->committed("", "")) centre_.reset();
  return ok({{"kind", "fleet"},
             {"version", rooms_.version},
             {"broker", rooms_.broker.load()},
             {"database", centre_.has_value()},
             {"time", control::utc_now()},
             {"day", {{"zone", memory::time_zone()}, {"begin", rooms_.day.begin()}}}});
}

Answer PageApi::read_for_metrics(const Call& call) {
  const Result<bool> may = accounts::may_read_metrics(rooms_.memory, rooms_.accounts, call.request.token);
  if (!may) return api::answer_of(may.error());
  if (!*may) return api::people::login_needed();
  return ok({{"state", read_state(call).body}, {"sensors", Json{}}});
}

Answer PageApi::list_cells(const Call&) {
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  const Result<std::vector<CellRow>> cells = (*here)->cells();
  if (!cells) return answer_of(cells.error());
  Json rows = Json::array();
  for (const CellRow& cell : *cells)
    rows.push_back({{"cell", cell.cell},
                    {"online", cell.online},
                    {"heard", memory::to_iso(cell.heard_ms)},
                    {"version", cell.version},
                    {"waiting", cell.waiting},
                    {"scans", cell.shoes},
                    {"ok", cell.ok},
                    {"amber", cell.amber},
                    {"review", cell.review},
                    {"refused", cell.refused},
                    {"failed", cell.failed},
                    {"last", cell.last_shoe_ms ? Json(memory::to_iso(*cell.last_shoe_ms)) : Json{}}});
  return ok({{"cells", std::move(rows)}});
}

Answer PageApi::list_alarms(const Call&) {
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  FleetNews news{.broker = rooms_.broker.load(), .database = true};
  Result<std::vector<CellRow>> cells = (*here)->cells();
  if (!cells) return answer_of(cells.error());
  news.cells = std::move(*cells);
  Result<std::vector<OddOfModel>> odd = odd_of_all(**here);
  if (!odd) return answer_of(odd.error());
  news.odd = std::move(*odd);
  const Result<std::vector<LastHour>> hours = Overview{**here}.last_hour();
  if (!hours) return answer_of(hours.error());
  Json rows = Json::array();
  for (const Alarm& alarm : alarms_of(news, *hours, memory::now_ms()))
    rows.push_back({{"code", alarm.code},
                    {"cell", api::or_null(alarm.cell)},
                    {"model", api::or_null(alarm.model)},
                    {"value", alarm.value}});
  return ok({{"alarms", std::move(rows)}});
}

Answer PageApi::list_odd_cells(const Call&) {
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  const Result<std::vector<OddOfModel>> all = odd_of_all(**here);
  if (!all) return answer_of(all.error());
  Json rows = Json::array();
  for (const auto& [model, odd] : *all)
    rows.push_back({{"model", model},
                    {"cell", odd.cell},
                    {"difference", to_text(odd.difference)},
                    {"mm", odd.mm},
                    {"u95_mm", odd.u95_mm},
                    {"scans", odd.shoes},
                    {"since", odd.since}});
  return ok({{"odd", std::move(rows)}});
}

Answer PageApi::list_releases(const Call&) {
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  const Result<std::vector<ReleaseRow>> releases = Releases{**here}.list();
  if (!releases) return answer_of(releases.error());
  Json rows = Json::array();
  for (const ReleaseRow& release : *releases) {
    Json cells = Json::array();
    for (const ReleaseCell& cell : release.cells)
      cells.push_back({{"cell", cell.cell},
                       {"ready", cell.ready},
                       {"in_force", cell.in_force},
                       {"why", api::or_null(cell.why)}});
    rows.push_back({{"number", release.number},
                    {"name", release.name},
                    {"sha256", release.sha256},
                    {"bytes", release.bytes},
                    {"cells", std::move(cells)}});
  }
  return ok({{"releases", std::move(rows)}});
}

}  // namespace biteline::fleet
