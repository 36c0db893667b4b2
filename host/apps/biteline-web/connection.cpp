// SPDX-License-Identifier: MIT
// One client: requests in, judged, answered.
#include "host/apps/biteline-web/connection.hpp"

#include <openssl/ssl.h>

#include <algorithm>
#include <array>

#include "common/core/text.hpp"
#include "host/apps/biteline-web/guards.hpp"
#include "host/apps/biteline-web/served_folder.hpp"
#include "host/apps/biteline-web/watcher.hpp"

namespace biteline::web {
namespace {

using control::Json;
using net::redirect_error;
using net::use_awaitable;

constexpr std::string_view k_cookie = "biteline_session";
constexpr std::size_t k_read_bytes = 4096;
constexpr std::size_t k_piece_bytes = 64 * 1024;
constexpr std::size_t k_most_openapi_bytes = 1U << 20U;

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

/// Cancels what the stream waits for when the time is over.
class Deadline {
 public:
  Deadline(WebStream& stream, std::chrono::milliseconds time)
      : timer_{stream.get_executor(), time}, over_{std::make_shared<bool>(false)} {
    timer_.async_wait([over = over_, &stream](ErrorCode fault) {
      if (fault) return;  // cancelled: the stream may be gone
      *over = true;
      stream.next_layer().cancel(fault);
    });
  }
  [[nodiscard]] bool over() const { return *over_; }

 private:
  net::steady_timer timer_;
  std::shared_ptr<bool> over_;
};

/// What came is no HTTP, or too much of it; other faults are the connection's.
bool is_fault_of_the_text(ErrorCode fault) {
  const ErrorCode of_http = http::error::end_of_stream;
  return fault && fault.category() == of_http.category() && fault != of_http;
}

/// The body of a list of files.
Json to_json(const std::vector<ListedFile>& files) {
  Json list = Json::array();
  for (const ListedFile& file : files) {
    list.push_back(
        {{"path", clean_text(file.path)}, {"bytes", file.size_bytes}, {"time", utc_text(file.changed_ns)}});
  }
  return {{"files", std::move(list)}};
}

std::string to_body(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

WebAnswer not_found(std::string_view path) {
  return error_answer(404, "not_found", clean_text(path, 200) + ": nothing of this name here");
}

WebAnswer login_needed() {
  return error_answer(401, "login_needed",
                      "a session is needed: POST /api/v1/sessions, then send its cookie or Authorization: "
                      "Bearer TOKEN");
}

/// The service's answer in HTTP's clothes.
WebAnswer as_http(const control::Answer& answer, std::string_view path) {
  if (answer.status == 204) return text_answer(204, "application/json", "");
  if (answer.body.is_string()) {
    const std::string_view type =
        path.ends_with(".csv") ? "text/csv; charset=utf-8" : "text/plain; charset=utf-8";
    return text_answer(answer.status, type, answer.body.get<std::string>());
  }
  return text_answer(answer.status, "application/json", to_body(answer.body));
}

}  // namespace

net::awaitable<control::Answer> ask_service(WebContext& context, control::Request request) {
  ++context.forwarded;
  const auto begin = [&context](auto handler, control::Request asked) {
    // Shared, because std::function wants copies; called once.
    const auto shared = std::make_shared<decltype(handler)>(std::move(handler));
    const auto executor = net::get_associated_executor(*shared);
    context.door->ask(std::move(asked), [shared, executor](control::Answer given) {
      net::post(executor, [shared, given = std::move(given)]() mutable { (*shared)(std::move(given)); });
    });
  };
  auto token = use_awaitable;
  const control::Answer answer = co_await net::async_initiate<net::use_awaitable_t<>, void(control::Answer)>(
      begin, token, std::move(request));
  if (answer.status == 503) ++context.host_away;
  co_return answer;
}

net::awaitable<control::Answer> ask_who(WebContext& context, std::string session, bool local) {
  control::Request request;
  request.token = std::move(session);
  request.local = local;
  request.door = "web";
  request.method = "GET";
  request.path = "/api/v1/me";
  co_return co_await ask_service(context, std::move(request));
}

Connection::Connection(WebContext& context, Tcp::socket socket, std::string peer, bool local)
    : context_{context},
      stream_{std::move(socket), context.tls ? &*context.tls : nullptr},
      peer_{std::move(peer)},
      local_{local} {}

net::awaitable<void> Connection::run() {
  {
    const Deadline deadline{stream_, context_.config.limits.request_time};
    if (co_await stream_.handshake()) co_return;
  }
  while (co_await one_request()) {
  }
  co_await linger();
}

net::awaitable<bool> Connection::one_request() {
  const WebLimits& limits = context_.config.limits;
  http::request_parser<http::string_body> parser;
  parser.header_limit(limits.header_bytes);
  parser.body_limit(limits.body_bytes);
  ErrorCode fault;
  if (buffer_.size() == 0) {
    // The time of a request begins with its first byte.
    const Deadline deadline{stream_, limits.idle_time};
    const std::size_t got =
        co_await stream_.async_read_some(buffer_.prepare(k_read_bytes), redirect_error(use_awaitable, fault));
    if (fault) co_return false;
    buffer_.commit(got);
  }
  const Deadline deadline{stream_, limits.request_time};
  co_await http::async_read(stream_, buffer_, parser, redirect_error(use_awaitable, fault));
  if (deadline.over() || is_fault_of_the_text(fault)) {
    co_await refuse_unread(deadline.over(), fault);
    co_return false;
  }
  if (fault) co_return false;
  ++context_.requests;
  const WebRequest request = parser.release();
  keep_alive_ = request.keep_alive();
  head_only_ = request.method() == http::verb::head;
  co_await answer(request);
  co_return keep_alive_ && !upgraded_;
}

net::awaitable<void> Connection::refuse_unread(bool late, ErrorCode fault) {
  ++context_.requests;
  keep_alive_ = false;
  head_only_ = false;
  if (late) {
    co_await send(error_answer(408, "too_slow", "the request did not come within the time limit"));
  } else if (fault == http::error::header_limit) {
    co_await send(error_answer(431, "header_too_large",
                               "the request's header has more than " +
                                   std::to_string(context_.config.limits.header_bytes) + " bytes"));
  } else if (fault == http::error::body_limit) {
    co_await send(error_answer(
        413, "too_large",
        "the request's body has more than " + std::to_string(context_.config.limits.body_bytes) + " bytes"));
  } else {
    co_await send(error_answer(400, "bad_request", "no HTTP/1.1 request: " + fault.message()));
  }
}

net::awaitable<void> Connection::send(WebAnswer answer, std::string_view policy) {
  const unsigned status = answer.result_int();
  if (status >= 400 && status < 500) ++context_.refused;
  put_security_headers(answer, policy, stream_.encrypted());
  answer.keep_alive(keep_alive_);
  if (status == 204) {
    answer.body().clear();
    answer.erase(http::field::content_type);
  } else {
    answer.content_length(answer.body().size());
  }
  if (head_only_) answer.body().clear();
  ErrorCode fault;
  const Deadline deadline{stream_, context_.config.limits.answer_time};
  http::response_serializer<http::string_body> serializer{answer};
  if (head_only_) {
    co_await http::async_write_header(stream_, serializer, redirect_error(use_awaitable, fault));
  } else {
    co_await http::async_write(stream_, serializer, redirect_error(use_awaitable, fault));
  }
  if (fault) keep_alive_ = false;
}

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
    co_await send_page(*path);
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
  const bool origin_is_own = origin_allowed({.origin = view(request[http::field::origin]),
                                             .fetch_site = view(request["Sec-Fetch-Site"]),
                                             .host = host,
                                             .tls = stream_.encrypted()});
  // A Foxglove client is a page of another origin; it shows a token, which no foreign page has.
  const bool foxglove = view(request.target()).starts_with("/foxglove?");
  // A link on another page may lead to ours; what it loads then is of our own origin.
  const bool navigation = request.method() == http::verb::get && request["Sec-Fetch-Mode"] == "navigate" &&
                          !view(request.target()).starts_with("/api/");
  if (!origin_is_own && !foxglove && !navigation) {
    return error_answer(403, "origin_refused", "a page of another origin may not ask this server");
  }
  return std::nullopt;
}

bool Connection::is_local(const WebRequest& request) const {
  // What a proxy passes on comes from elsewhere, whatever its own address is.
  const bool passed_on =
      request.count("Forwarded") + request.count("X-Forwarded-For") + request.count("Via") > 0;
  return local_ && !passed_on && !context_.config.behind_proxy;
}

std::string Connection::session_of(const WebRequest& request, const Asked& asked) {
  std::string token = bearer_token(view(request[http::field::authorization]));
  if (token.empty()) token = cookie_value(view(request[http::field::cookie]), k_cookie);
  if (token.empty() && asked.match.route->handling == Handling::Foxglove) {
    if (const auto given = asked.query.find("token"); given != asked.query.end()) token = given->second;
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
  const std::string session = session_of(request, asked);
  if (session.empty()) {
    co_await send(login_needed());
    co_return;
  }
  const control::Answer who = co_await ask_who(context_, session, is_local(request));
  if (who.status != 200) {
    co_await send(as_http(who, asked.path));
    co_return;
  }
  switch (route.handling) {
    case Handling::FileList:
      co_await send_file_list(asked.match.named.at("id"));
      break;
    case Handling::File:
      co_await send_result_file(request, asked.match.named.at("id"), asked.match.named.at("path"));
      break;
    case Handling::Metrics:
      co_await send_metrics(session);
      break;
    default:
      co_await watch(request, route.handling, session);
      break;
  }
}

net::awaitable<void> Connection::forward(const WebRequest& request, Asked asked) {
  const Handling handling = asked.match.route->handling;
  control::Request question;
  question.token = session_of(request, asked);
  question.local = is_local(request);
  question.door = "web";
  question.method = asked.match.route->method;
  question.path = asked.path;
  question.query = std::move(asked.query);
  // The service takes the first account from the cell's own machine, and no other without a session.
  const bool first_account = question.method == "POST" && asked.path == "/api/v1/users";
  const bool local_command = question.local && (first_account || asked.path == "/api/v1/commands/stop" ||
                                                asked.path == "/api/v1/commands/laser-off");
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
  const control::Answer given = co_await ask_service(context_, std::move(question));
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

net::awaitable<void> Connection::send_openapi() {
  const auto file =
      open_served_file(context_.config.openapi.parent_path(), context_.config.openapi.filename());
  std::string text(file ? std::min<std::uint64_t>(file->size_bytes(), k_most_openapi_bytes) : 0, '\0');
  if (!file || !file->read(0, text)) {
    co_await send(error_answer(404, "not_found", "openapi.yaml is not beside the program (share/biteline)"));
    co_return;
  }
  co_await send(text_answer(200, "application/yaml", std::move(text)));
}

net::awaitable<void> Connection::send_metrics(std::string session) {
  std::array<Json, 2> bodies;
  const std::array<std::string, 2> paths{"/api/v1/state", "/api/v1/sensors"};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    control::Request question;
    question.token = session;
    question.door = "web";
    question.method = "GET";
    question.path = paths[i];
    control::Answer given = co_await ask_service(context_, std::move(question));
    if (given.status == 200) bodies[i] = std::move(given.body);
  }
  co_await send(text_answer(200, "text/plain; version=0.0.4; charset=utf-8",
                            metrics_text(context_.counts(), bodies[0], bodies[1])));
}

net::awaitable<void> Connection::send_file_list(std::string scan) {
  if (context_.results.empty()) {
    co_await send(
        error_answer(503, "host_away", "the service has not yet said where its results are: try again"));
    co_return;
  }
  const auto files = is_scan_name(scan) ? list_served_files(context_.results, scan)
                                        : Result<std::vector<ListedFile>>{fail(Errc::FileNotFound, "scan")};
  if (!files) {
    co_await send(not_found(scan));
    co_return;
  }
  co_await send(text_answer(200, "application/json", to_body(to_json(*files))));
}

net::awaitable<void> Connection::send_result_file(const WebRequest& request, std::string scan,
                                                  std::string path) {
  if (context_.results.empty()) {
    co_await send(
        error_answer(503, "host_away", "the service has not yet said where its results are: try again"));
    co_return;
  }
  const std::string within = scan + "/" + path;
  // Hidden files are the program's own.
  const bool hidden = path.starts_with('.') || path.find("/.") != std::string::npos;
  auto file = is_scan_name(scan) && !hidden ? open_served_file(context_.results, within)
                                            : Result<ServedFile>{fail(Errc::FileNotFound, "file")};
  if (!file) {
    co_await send(not_found(path));
    co_return;
  }
  co_await send_file(*file, path, view(request[http::field::range]), FileKind::Result);
}

net::awaitable<void> Connection::send_page(std::string path) {
  path.erase(0, 1);
  if (path.empty() || path.ends_with('/')) path += "index.html";
  auto file = open_served_file(context_.config.page, path);
  if (!file) {
    WebAnswer refusal = not_found("/" + path);
    if (path == "index.html") {
      refusal =
          error_answer(404, "not_found", "the page is not there: build it, or name its folder with --page");
    }
    co_await send(std::move(refusal));
    co_return;
  }
  co_await send_file(*file, path, {}, FileKind::Page);
}

net::awaitable<void> Connection::send_file(const ServedFile& file, std::string path, std::string_view range,
                                           FileKind kind) {
  const RangeAnswer part = read_range(range, file.size_bytes());
  if (part.kind == RangeKind::Refused) {
    WebAnswer refusal = error_answer(416, "range_refused", "the range lies beyond the file's end");
    refusal.set(http::field::content_range, "bytes */" + std::to_string(file.size_bytes()));
    co_await send(std::move(refusal));
    co_return;
  }
  std::uint64_t at = part.kind == RangeKind::Part ? part.range.first : 0;
  const std::uint64_t end = part.kind == RangeKind::Part ? part.range.last + 1 : file.size_bytes();
  http::response<http::empty_body> header{
      part.kind == RangeKind::Part ? http::status::partial_content : http::status::ok, 11};
  const std::string_view type = content_type(path);
  const bool result_page = kind == FileKind::Result && type.starts_with("text/html");
  put_security_headers(header,
                       kind == FileKind::Page ? k_page_policy
                       : result_page          ? k_result_page_policy
                                              : k_data_policy,
                       stream_.encrypted());
  header.set(http::field::content_type, beast::string_view{type.data(), type.size()});
  header.set(http::field::cache_control, kind == FileKind::Page ? "no-cache" : "private, no-cache");
  header.set(http::field::accept_ranges, "bytes");
  if (part.kind == RangeKind::Part) {
    header.set(http::field::content_range, "bytes " + std::to_string(at) + "-" + std::to_string(end - 1) +
                                               "/" + std::to_string(file.size_bytes()));
  }
  header.content_length(end - at);
  header.keep_alive(keep_alive_);
  ErrorCode fault;
  http::response_serializer<http::empty_body> serializer{header};
  {
    const Deadline deadline{stream_, context_.config.limits.answer_time};
    co_await http::async_write_header(stream_, serializer, redirect_error(use_awaitable, fault));
  }
  std::string piece;
  while (!fault && !head_only_ && at < end) {
    piece.resize(std::min<std::uint64_t>(k_piece_bytes, end - at));
    const Result<std::size_t> got = file.read(at, piece);
    // A file that became shorter meanwhile: the client sees that the answer is cut.
    if (!got || *got < piece.size()) {
      keep_alive_ = false;
      co_return;
    }
    const Deadline deadline{stream_, context_.config.limits.answer_time};
    co_await net::async_write(stream_, net::buffer(piece), redirect_error(use_awaitable, fault));
    at += piece.size();
  }
  if (fault) keep_alive_ = false;
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

/// Lets the client read the last answer: a connection that is closed while bytes of it are unread is reset,
/// and the answer lost.
net::awaitable<void> Connection::linger() {
  constexpr std::size_t k_most_bytes = 1U << 20U;
  constexpr std::chrono::milliseconds k_time{1000};
  ErrorCode fault;
  if (upgraded_) co_return;
  stream_.next_layer().shutdown(Tcp::socket::shutdown_send, fault);
  const Deadline deadline{stream_, k_time};
  std::string waste(4096, '\0');
  for (std::size_t swallowed = 0; !fault && swallowed < k_most_bytes && !deadline.over();) {
    swallowed += co_await stream_.next_layer().async_read_some(net::buffer(waste),
                                                               redirect_error(use_awaitable, fault));
  }
}

net::awaitable<void> serve_connection(WebContext& context, Tcp::socket socket) {
  ErrorCode fault;
  const auto remote = socket.remote_endpoint(fault).address();
  if (fault) co_return;
  const auto own = socket.local_endpoint(fault).address();
  if (fault) co_return;
  socket.set_option(Tcp::no_delay{true}, fault);
  const std::string peer = remote.to_string();
  int& of_peer = context.connections_of[peer];
  const WebLimits& limits = context.config.limits;
  const bool full = context.connections >= limits.connections || of_peer >= limits.connections_an_address;
  ++context.connections;
  ++of_peer;
  {
    Connection connection{context, std::move(socket), peer, remote.is_loopback() || remote == own};
    try {
      if (full) {
        co_await connection.turn_away();
      } else {
        co_await connection.run();
      }
    } catch (const std::exception& /*error*/) {
      // Out of memory for this one client: it goes, the others stay.
      ++context.refused;
    }
  }
  --context.connections;
  if (--context.connections_of[peer] == 0) context.connections_of.erase(peer);
}

net::awaitable<void> Connection::turn_away() {
  keep_alive_ = false;
  {
    const Deadline deadline{stream_, context_.config.limits.request_time};
    if (co_await stream_.handshake()) co_return;
  }
  co_await send(error_answer(503, "too_busy", "too many connections: close some, then try again"));
  co_await linger();
}

}  // namespace biteline::web
