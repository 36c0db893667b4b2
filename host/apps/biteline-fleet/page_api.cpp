// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/page_api.hpp"

#include <algorithm>
#include <array>

#include "host/interfaces/api/json_fields.hpp"
#include "host/interfaces/api/people.hpp"

namespace biteline::fleet {

using accounts::Person;
using control::Answer;
using control::Request;

namespace {

/// Counting all shoes takes the database longer the more there are: a tenth of its time, at most.
constexpr std::chrono::milliseconds k_fresh{3000};
constexpr int k_rest = 10;
constexpr std::size_t k_most_kept = 200;

}  // namespace

struct PageApi::Row : api::Route {
  Answer (PageApi::*answer)(const Call&);
};

std::span<const PageApi::Row> PageApi::rows() {
  static constexpr std::array k_rows{
#include "host/interfaces/api/centre_routes.inc"
  };
  return k_rows;
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
  const api::Match<Row> match = api::find_route(rows(), request.method, request.path);
  if (match.route == nullptr && !match.methods.empty())
    return control::refusal(405, "method_not_allowed", "another method is expected at this path");
  if (match.route == nullptr)
    return control::refusal(404, "not_found", "the centre has no such path; it commands no cell");
  const Row& row = *match.route;
  const Result<std::optional<Person>> person = rooms_.accounts.who_is(request.token);
  if (!person) return api::answer_of(person.error());
  if (row.role) {
    if (const std::optional<Answer> closed = api::people::closed_to(*person, *row.role)) return *closed;
  }
  const Call call{.request = request, .person = person->value_or(Person{}), .names = match.names};
  // A page further back is asked for once, and a thousand shoes are megabytes.
  const bool counts = request.method == "GET" && row.pattern.starts_with("/api/v1/fleet/") &&
                      row.operation != "list_fetches" && !request.query.contains("cursor");
  return counts ? kept_or(call, row.answer) : (this->*row.answer)(call);
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
