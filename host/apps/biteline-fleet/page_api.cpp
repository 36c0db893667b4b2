// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/page_api.hpp"

#include <algorithm>

#include "host/doors/api/people.hpp"
#include "host/doors/api/words.hpp"

namespace biteline::fleet {

using accounts::Person;
using accounts::Role;
using control::Answer;
using control::Request;

namespace {

constexpr std::string_view k_root = "/api/v1";
constexpr std::string_view k_user = "/users/";
constexpr std::string_view k_fetches = "/fleet/fetches";
/// Counting all shoes takes the database longer the more there are: a tenth of its time, at most.
constexpr std::chrono::milliseconds k_fresh{3000};
constexpr int k_rest = 10;
constexpr std::size_t k_most_kept = 200;

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

}  // namespace biteline::fleet
