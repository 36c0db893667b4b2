// SPDX-License-Identifier: MIT
// A request: judged, and given to whoever answers it.
#include <utility>

#include "common/core/text.hpp"
#include "host/apps/biteline-web/connection.hpp"
#include "host/apps/biteline-web/guards.hpp"
#include "host/apps/biteline-web/watcher.hpp"
#include "host/interfaces/accounts/first_token.hpp"

namespace biteline::web {
namespace {

using control::Json;

constexpr std::string_view k_cookie = "biteline_session";

}  // namespace

net::awaitable<void> Connection::answer(const WebRequest& request) {
  if (std::optional<WebAnswer> refusal = judge(request)) {
    co_await send(std::move(*refusal));
    co_return;
  }
  const std::string_view target = view(request.target());
  const std::size_t question = target.find('?');
  const std::optional<std::string> path = decode_path(target.substr(0, question));
  const auto query = decode_query(question == std::string_view::npos ? "" : target.substr(question + 1));
  if (!path || !query) {
    co_await send(error_answer(
        400, "bad_request",
        "the address cannot be read: a path from / expected, without .. and with sound escapes"));
    co_return;
  }
  const RouteMatch match = find_route(view(request.method_string()), *path);
  const bool of_page = match.methods.empty() && !path->starts_with("/api/");
  if (std::optional<WebAnswer> refusal = judge_origin(request, match.route, of_page)) {
    co_await send(std::move(*refusal));
    co_return;
  }
  if (match.route != nullptr) {
    Asked asked{.match = match, .path = *path, .query = *query};
    co_await answer_route(request, std::move(asked));
  } else if (!match.methods.empty()) {
    WebAnswer refusal =
        error_answer(405, "method_not_allowed", *path + ": this method is not for it; see the header Allow");
    std::string allowed;
    for (const std::string_view method : match.methods) {
      if (allowed.find(method) == std::string::npos)
        allowed += (allowed.empty() ? "" : ", ") + std::string{method};
    }
    refusal.set(http::field::allow, allowed);
    co_await send(std::move(refusal));
  } else if (path->starts_with("/api/")) {
    co_await send(not_found(*path));
  } else if (request.method() != http::verb::get && !head_only_) {
    WebAnswer refusal = error_answer(405, "method_not_allowed",
                                     clean_text(*path, 200) + ": this method is not for the page's files");
    refusal.set(http::field::allow, "GET, HEAD");
    co_await send(std::move(refusal));
  } else {
    co_await send_page(request, *path);
  }
}

std::optional<WebAnswer> Connection::judge(const WebRequest& request) const {
  if (request.version() != 11 && request.version() != 10) {
    return error_answer(400, "bad_request", "HTTP/1.1 expected");
  }
  if (request.count(http::field::host) != 1) {
    return error_answer(400, "bad_request", "exactly one Host header expected");
  }
  const std::string_view host = view(request[http::field::host]);
  if (!host_allowed(host, context_.host_names)) {
    return error_answer(
        421, "other_host",
        clean_text(host, 100) + ": not a name of this server; start it with --name NAME if it is");
  }
  return std::nullopt;
}

bool Connection::origin_is_own(const WebRequest& request) const {
  return origin_allowed({.origin = view(request[http::field::origin]),
                         .fetch_site = view(request["Sec-Fetch-Site"]),
                         .host = view(request[http::field::host]),
                         .tls = stream_.encrypted()});
}

std::optional<WebAnswer> Connection::judge_origin(const WebRequest& request, const Route* route,
                                                  bool of_page) const {
  if (origin_is_own(request)) return std::nullopt;
  // A Foxglove client is a page of another origin; it shows a token, which no foreign page has.  The cookie
  // of whoever sits there counts for nothing then (session_of()).
  if (route != nullptr && route->handling == Handling::Foxglove) return std::nullopt;
  // A link on another page may lead to ours; what it loads then is of our own origin.
  if (of_page && request.method() == http::verb::get && request["Sec-Fetch-Mode"] == "navigate")
    return std::nullopt;
  return error_answer(403, "origin_refused", "a page of another origin may not ask this server");
}

void Connection::note_session(const control::Answer& given, const std::string& token) {
  if (!token.empty() && given.status < 400) context_.places.stand(place_, Places::Standing::Known);
}

bool Connection::is_local(const WebRequest& request) const {
  // What a proxy passes on comes from elsewhere, whatever its own address is.
  const bool passed_on =
      request.count("Forwarded") + request.count("X-Forwarded-For") + request.count("Via") > 0;
  return local_ && !passed_on && !context_.config.behind_proxy;
}

std::string Connection::session_of(const WebRequest& request, Handling handling,
                                   const std::map<std::string, std::string>& query) const {
  std::string token;
  // What a browser adds by itself is no word of a page of another origin.
  if (origin_is_own(request)) {
    token = bearer_token(view(request[http::field::authorization]));
    if (token.empty()) token = cookie_value(view(request[http::field::cookie]), k_cookie);
  }
  if (token.empty() && handling == Handling::Foxglove) {
    if (const auto given = query.find("token"); given != query.end()) token = given->second;
  }
  return is_token(token) ? token : std::string{};
}

net::awaitable<void> Connection::answer_route(const WebRequest& request, Asked asked) {
  const Route& route = *asked.match.route;
  if (route.handling == Handling::Openapi) {
    co_await send_openapi();
    co_return;
  }
  if (route.handling == Handling::Forward || route.handling == Handling::Login ||
      route.handling == Handling::Logout) {
    co_await forward(request, std::move(asked));
    co_return;
  }
  const std::string session = session_of(request, route.handling, asked.query);
  if (session.empty()) {
    co_await send(login_needed());
    co_return;
  }
  // The service knows who may: a program's own token is no session.
  if (route.handling == Handling::Metrics) {
    co_await send_metrics(session);
    co_return;
  }
  const control::Answer who = co_await ask_who(context_, session, is_local(request));
  note_session(who, session);
  if (who.status != 200) {
    co_await send(as_http(who, asked.path));
    co_return;
  }
  switch (route.handling) {
    case Handling::FileList:
      co_await send_file_list(asked.match.names.front());
      break;
    case Handling::File:
      co_await send_result_file(request, asked.match.names.front(), asked.match.names.back());
      break;
    default:
      co_await watch(request, route.handling, session);
      break;
  }
}

net::awaitable<std::string> Connection::first_token() {
  // A service that has just been found may not have said hello yet.
  constexpr int k_looks = 40;
  for (int look = 0; look < k_looks && context_.accounts.empty(); ++look) {
    net::steady_timer pause{co_await net::this_coro::executor, std::chrono::milliseconds{50}};
    co_await pause.async_wait(net::use_awaitable);
  }
  co_return context_.accounts.empty() ? std::string{} : accounts::read_first_token(context_.accounts);
}

net::awaitable<void> Connection::forward(const WebRequest& request, Asked asked) {
  const Route& route = *asked.match.route;
  const Handling handling = route.handling;
  control::Request question;
  question.token = session_of(request, handling, asked.query);
  question.local = is_local(request);
  question.door = "web";
  question.method = route.method;
  question.path = asked.path;
  question.query = std::move(asked.query);
  // The service takes the first account from the cell's own machine, and no other without a session.
  const bool local_command = question.local && route.local;
  const bool first_account = route.operation == "add_user";
  if (local_command && first_account && question.token.empty()) question.token = co_await first_token();
  if (question.token.empty() && handling != Handling::Login && !local_command) {
    co_await send(login_needed());
    co_return;
  }
  if (!request.body().empty()) {
    if (!view(request[http::field::content_type]).starts_with("application/json")) {
      co_await send(
          error_answer(415, "wrong_type", "a body must be JSON, with Content-Type: application/json"));
      co_return;
    }
    std::optional<Json> body = control::parse_bounded(request.body());
    if (!body || !body->is_object()) {
      co_await send(error_answer(400, "bad_request", "the body is no JSON object"));
      co_return;
    }
    question.body = std::move(*body);
  }
  if (handling == Handling::Login) {
    co_await log_in(std::move(question));
    co_return;
  }
  const std::string token = local_command ? std::string{} : question.token;
  const control::Answer given = co_await ask_service(context_, std::move(question));
  note_session(given, token);
  if (!given.file.empty()) {
    std::string name;
    if (!asked.match.names.empty()) name = asked.match.names.front();
    co_await send_download(given, std::move(name));
    co_return;
  }
  WebAnswer out = as_http(given, asked.path);
  if (handling == Handling::Logout) out.set(http::field::set_cookie, cookie_text("", true));
  co_await send(std::move(out));
}

std::string Connection::cookie_text(const std::string& token, bool gone) const {
  return std::string{k_cookie} + "=" + token + "; Path=/; HttpOnly; SameSite=Strict" +
         (stream_.encrypted() ? "; Secure" : "") + (gone ? "; Max-Age=0" : "");
}

net::awaitable<void> Connection::log_in(control::Request question) {
  if (!context_.login_limit.take(peer_, LoginLimit::Clock::now())) {
    WebAnswer refusal =
        error_answer(429, "too_many", "too many logins from here: wait some seconds, then try again");
    refusal.set(http::field::retry_after, std::to_string(static_cast<int>(LoginLimit::k_seconds_a_try)));
    co_await send(std::move(refusal));
    co_return;
  }
  bool as_cookie = false;
  if (question.body.is_object()) {
    if (const auto wish = question.body.find("cookie"); wish != question.body.end()) {
      as_cookie = wish->is_boolean() && wish->get<bool>();
      question.body.erase("cookie");
    }
  }
  control::Answer given = co_await ask_service(context_, std::move(question));
  if (given.status == 201) context_.login_limit.give_back(peer_, LoginLimit::Clock::now());
  std::string cookie;
  if (given.status == 201 && as_cookie && given.body.is_object()) {
    const auto token = given.body.find("token");
    if (token == given.body.end() || !token->is_string() || !is_token(token->get<std::string>())) {
      co_await send(error_answer(500, "internal", "the service gave no token that can be a cookie"));
      co_return;
    }
    cookie = cookie_text(token->get<std::string>(), false);
    given.body.erase("token");
  }
  WebAnswer out = as_http(given, "/api/v1/sessions");
  if (!cookie.empty()) out.set(http::field::set_cookie, cookie);
  co_await send(std::move(out));
}

net::awaitable<void> Connection::watch(const WebRequest& request, Handling handling, std::string session) {
  if (!websocket::is_upgrade(request)) {
    WebAnswer refusal = error_answer(426, "upgrade_needed", "this address is a WebSocket");
    refusal.set(http::field::upgrade, "websocket");
    co_await send(std::move(refusal));
    co_return;
  }
  upgraded_ = true;
  WatcherRequest watcher{.stream = stream_,
                         .request = request,
                         .handling = handling,
                         .session = std::move(session),
                         .local = is_local(request)};
  co_await serve_watcher(context_, std::move(watcher));
}

}  // namespace biteline::web
