// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/page_api.hpp"

#include <algorithm>

#include "host/doors/accounts/metrics_token.hpp"
#include "host/doors/api/people.hpp"
#include "host/doors/api/words.hpp"
#include "host/fleet/alarms.hpp"
#include "host/fleet/releases.hpp"
#include "host/records/memory/history.hpp"

namespace biteline::fleet {

using accounts::Person;
using accounts::Role;
using api::ok;
using control::Answer;
using control::Json;
using control::Request;

namespace {

constexpr std::string_view k_root = "/api/v1";
constexpr std::string_view k_user = "/users/";
constexpr std::string_view k_fetches = "/fleet/fetches";
/// Counting all shoes takes the database longer the more there are: a tenth of its time, at most.
constexpr std::chrono::milliseconds k_fresh{3000};
constexpr int k_rest = 10;
constexpr std::size_t k_most_kept = 200;

std::string query_text(const Request& request, const char* key) {
  const auto found = request.query.find(key);
  return found == request.query.end() ? std::string{} : found->second;
}

/// The cell's own filter, beside which the centre knows one more.
api::QueryFilter filter_of(const Request& request) {
  std::map<std::string, std::string> query = request.query;
  query.erase("cell");
  return api::filter_of(query);
}

Json sums_json(const memory::Trend& sums) {
  return {{"scans", sums.scans},
          {"ok", sums.ok},
          {"amber", sums.amber},
          {"refused", sums.refused},
          {"failed", sums.failed},
          {"length_mm", api::or_null(sums.mean_length_mm)},
          {"u95_mm", api::or_null(sums.median_u95_mm)},
          {"cycle_s", api::or_null(sums.median_cycle_s)}};
}

}  // namespace

struct PageApi::Route {
  const char* method;
  std::string_view path;
  std::optional<Role> role;  ///< nothing: nobody need be logged in
  Answer (PageApi::*answer)(const Call&);
  Answer (*of_people)(accounts::Accounts&, const Call&);
};

std::vector<PageApi::Route> PageApi::routes() {
  using enum Role;
  const auto people = [](const char* method, std::string_view path, std::optional<Role> role,
                         Answer (*answer)(accounts::Accounts&, const Call&)) {
    return Route{method, path, role, nullptr, answer};
  };
  namespace login = api::people;
  return {
      people("POST", "/sessions", std::nullopt,
             [](accounts::Accounts& all, const Call& call) { return login::log_in(all, call.request); }),
      people("DELETE", "/sessions", Viewer,
             [](accounts::Accounts& all, const Call& call) { return login::log_out(all, call.request); }),
      people("GET", "/me", Viewer,
             [](accounts::Accounts& all, const Call& call) {
               return login::read_me(all, call.request, call.person);
             }),
      people("GET", "/users", Administrator,
             [](accounts::Accounts& all, const Call&) { return login::list_users(all); }),
      people("POST", "/users", std::nullopt,
             [](accounts::Accounts& all, const Call& call) {
               return login::add_user(all, call.request, call.person);
             }),
      people("PATCH", k_user, Viewer,
             [](accounts::Accounts& all, const Call& call) {
               return login::change_user(all, call.request, call.person, call.name);
             }),
      people("DELETE", k_user, Administrator,
             [](accounts::Accounts& all, const Call& call) {
               return login::remove_user(all, call.request, call.person, call.name);
             }),
      {"GET", "/state", Viewer, &PageApi::read_state, nullptr},
      // Between programs, as at a cell: what the centre's biteline-web makes its /metrics of.
      {"GET", "/exchange/metrics", std::nullopt, &PageApi::read_for_metrics, nullptr},
      {"GET", "/log", Engineer, &PageApi::read_log, nullptr},
      {"GET", "/fleet/scans", Viewer, &PageApi::list_shoes, nullptr},
      {"GET", "/fleet/trends", Viewer, &PageApi::read_trends, nullptr},
      {"GET", "/fleet/cells", Viewer, &PageApi::list_cells, nullptr},
      {"GET", "/fleet/groups", Viewer, &PageApi::list_groups, nullptr},
      {"GET", "/fleet/alarms", Viewer, &PageApi::list_alarms, nullptr},
      {"GET", "/fleet/odd", Viewer, &PageApi::list_odd, nullptr},
      {"GET", "/fleet/releases", Viewer, &PageApi::list_releases, nullptr},
      {"GET", k_fetches, Viewer, &PageApi::list_fetches, nullptr},
      {"POST", k_fetches, Engineer, &PageApi::fetch, nullptr},
      {"POST", "/fleet/marks", Engineer, &PageApi::mark, nullptr},
  };
}

Answer PageApi::answer(const Request& request) {
  // Of the libraries below (JSON, database): the request's fault or a defect, never the centre's end.
  try {
    return dispatch(request);
  } catch (const std::exception& error) {
    return control::refusal(500, "internal", std::string{"internal failure: "} + error.what());
  }
}

Answer PageApi::dispatch(const Request& request) {
  static const std::vector<Route> k_routes = routes();
  const std::string_view path = request.path.starts_with(k_root)
                                    ? std::string_view{request.path}.substr(k_root.size())
                                    : std::string_view{};
  const bool user = path.starts_with(k_user) && path.size() > k_user.size();
  bool other_method = false;
  for (const Route& route : k_routes) {
    if (user ? route.path != k_user : route.path != path) continue;
    if (request.method != route.method) {
      other_method = true;
      continue;
    }
    const Result<std::optional<Person>> person = rooms_.accounts.who_is(request.token);
    if (!person) return api::answer_of(person.error());
    if (route.role) {
      if (const std::optional<Answer> closed = api::people::closed_to(*person, *route.role)) return *closed;
    }
    const Call call{.request = request,
                    .person = person->value_or(Person{}),
                    .name = user ? std::string{path.substr(k_user.size())} : std::string{}};
    if (route.of_people != nullptr) return route.of_people(rooms_.accounts, call);
    // A page further back is asked for once, and a thousand shoes are megabytes.
    const bool counts = request.method == "GET" && path.starts_with("/fleet/") && path != k_fetches &&
                        !request.query.contains("cursor");
    return counts ? kept_or(call, route.answer) : (this->*route.answer)(call);
  }
  if (other_method)
    return control::refusal(405, "method_not_allowed", "another method is expected at this path");
  return control::refusal(404, "not_found", "the centre has no such path; it commands no cell");
}

Answer PageApi::kept_or(const Call& call, Answer (PageApi::*asked)(const Call&)) {
  std::string key = call.request.path;
  for (const auto& [name, value] : call.request.query)
    key.append("\n").append(name).append("=").append(value);
  const auto begin = std::chrono::steady_clock::now();
  if (const auto found = kept_.find(key); found != kept_.end() && begin < found->second.until)
    return found->second.answer;
  Answer fresh = (this->*asked)(call);
  const auto end = std::chrono::steady_clock::now();
  std::erase_if(kept_, [end](const auto& one) { return one.second.until <= end; });
  if (fresh.status == 200 && kept_.size() < k_most_kept)
    kept_[key] = {.until = end + std::max<std::chrono::nanoseconds>(k_fresh, k_rest * (end - begin)),
                  .answer = fresh};
  return fresh;
}

Result<Centre*> PageApi::centre() {
  if (!centre_) {
    BITELINE_ASSIGN(Centre centre, Centre::open(rooms_.database, rooms_.migrations));
    centre_.emplace(std::move(centre));
  }
  return &*centre_;
}

Answer PageApi::answer_of(const Error& error) {
  const bool away = error.code == Errc::ConnectFailed || error.code == Errc::ConnectionLost ||
                    error.code == Errc::DeviceError;
  if (!away) return api::answer_of(error);
  centre_.reset();
  return control::refusal(503, "database_away", "the centre's database does not answer; the cells keep all");
}

Answer PageApi::read_state(const Call&) {
  Result<Centre*> here = centre();
  // One that went away is noticed by asking; not for what counts all shoes, since every page asks each 5 s.
  if (here && !(*here)->committed("", "")) centre_.reset();
  return ok({{"kind", "fleet"},
             {"version", rooms_.version},
             {"broker", rooms_.broker.load()},
             {"database", centre_.has_value()},
             {"time", control::utc_now()}});
}

Answer PageApi::read_for_metrics(const Call& call) {
  const Result<bool> may = accounts::may_read_metrics(rooms_.memory, rooms_.accounts, call.request.token);
  if (!may) return api::answer_of(may.error());
  if (!*may) return api::people::login_needed();
  return ok({{"state", read_state(call).body}, {"sensors", Json{}}});
}

Answer PageApi::read_log(const Call& call) {
  const api::QueryFilter query = filter_of(call.request);
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
                    {"refused", cell.refused},
                    {"failed", cell.failed},
                    {"last", cell.last_shoe_ms ? Json(memory::to_iso(*cell.last_shoe_ms)) : Json{}}});
  return ok({{"cells", std::move(rows)}});
}

Answer PageApi::list_shoes(const Call& call) {
  const api::QueryFilter query = filter_of(call.request);
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

Answer PageApi::read_trends(const Call& call) {
  const api::QueryFilter query = filter_of(call.request);
  if (query.fault) return *query.fault;
  const std::string asked = query_text(call.request, "bucket");
  const std::string bucket = asked.empty() ? "day" : asked;
  if (bucket != "hour" && bucket != "day" && bucket != "week")
    return control::refusal(400, "bad_request", "query bucket: hour, day or week expected");
  const memory::UnixMs bucket_ms =
      bucket == "hour" ? memory::k_day_ms / 24 : (bucket == "week" ? 7 : 1) * memory::k_day_ms;
  const Result<Centre*> here = centre();
  if (!here) return answer_of(here.error());
  const Result<memory::Trends> trends =
      Overview{**here}.trends(query_text(call.request, "cell"), query.filter, bucket_ms);
  return trends ? ok(memory::to_json(*trends)) : answer_of(trends.error());
}

Answer PageApi::list_groups(const Call& call) {
  const api::QueryFilter query = filter_of(call.request);
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

Answer PageApi::list_odd(const Call&) {
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
