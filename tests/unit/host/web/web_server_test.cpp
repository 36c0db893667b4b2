// SPDX-License-Identifier: MIT
// The server against a made service: what it lets through, what it refuses, and that nobody holds it up.
#include "host/apps/biteline-web/web_server.hpp"

#include <CppUTest/TestHarness.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <random>
#include <thread>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/web_client.hpp"

namespace biteline::web {
namespace {

using control::Answer;
using control::Json;
using test::WebClient;
using test::WebReply;

const std::string k_session{"Authorization: Bearer viewer-token\r\n"};
constexpr const char* k_login = R"({"name":"ada","password":"correct horse"})";

/// Knows one user, and tells what it was asked.
class MadeService final : public ServiceDoor {
 public:
  void ask(control::Request request, OnAnswer on_answer) override {
    const std::lock_guard lock{mutex_};
    asked_.push_back(request);
    on_answer(away_ ? control::refusal(503, "host_away", "nobody there") : answer(request));
  }
  void listen(OnEvent on_event) override {
    const std::lock_guard lock{mutex_};
    on_event_ = std::move(on_event);
  }

  void tell(const control::Event& event) {
    const std::lock_guard lock{mutex_};
    on_event_(event);
  }
  void go(bool away) {
    const std::lock_guard lock{mutex_};
    away_ = away;
  }
  void end_session() {
    const std::lock_guard lock{mutex_};
    session_ended_ = true;
  }
  std::vector<control::Request> asked() {
    const std::lock_guard lock{mutex_};
    return asked_;
  }

 private:
  Answer answer(const control::Request& request) const {
    const bool known = request.token == "viewer-token" && !session_ended_;
    if (request.path == "/api/v1/sessions" && request.method == "POST") {
      if (request.body.value("password", "") != "correct horse") {
        return control::refusal(401, "wrong_password", "name or password is wrong");
      }
      return {.id = 0,
              .status = 201,
              .body = {{"token", "viewer-token"}, {"user", {{"name", "ada"}, {"role", "viewer"}}}}};
    }
    const bool stop = request.path == "/api/v1/commands/stop" || request.path == "/api/v1/commands/laser-off";
    if (stop && request.local) return {.id = 0, .status = 200, .body = {{"done", true}}};
    if (!known) return control::refusal(401, "login_needed", "log in");
    if (request.path == "/api/v1/me")
      return {.id = 0, .status = 200, .body = {{"name", "ada"}, {"role", "viewer"}}};
    if (request.path == "/api/v1/history.csv") return {.id = 0, .status = 200, .body = "scan,verdict\n"};
    if (request.path == "/api/v1/scans") {
      const Json scan{{"id", "scan-0001"}, {"verdict", "ok"}};
      return {.id = 0, .status = 200, .body = {{"scans", Json::array({scan})}, {"next", nullptr}}};
    }
    if (request.method == "DELETE") return {.id = 0, .status = 204, .body = {}};
    return {
        .id = 0,
        .status = 200,
        .body = {
            {"now", "waiting"}, {"path", request.path}, {"query", request.query}, {"body", request.body}}};
  }

  std::mutex mutex_;
  OnEvent on_event_;
  std::vector<control::Request> asked_;
  bool away_{false};
  bool session_ended_{false};
};

/// A server that runs, with a results folder and a page.
struct RunningServer {
  explicit RunningServer(const WebLimits& limits = {}, const std::optional<TlsFiles>& tls = {}) {
    folder.write("page/index.html", "<!doctype html><title>page</title>");
    folder.write("page/app.js", "1;");
    folder.write("results/scan-0001/line.csv", "0123456789");
    folder.write("results/scan-0001/path/tracking.html", "<script>1</script>");
    folder.write("secret", "hidden words");
    WebConfig config;
    config.port = 0;
    config.page = folder.path() / "page";
    config.openapi = folder.write("share/openapi.yaml", "openapi: 3.1.0\n");
    config.limits = limits;
    config.tls = tls;
    auto door = std::make_unique<MadeService>();
    service = door.get();
    auto opened = WebServer::open(config, std::move(door));
    SUCCEEDS(opened);
    server = std::move(*opened);
    thread = std::thread{[this] { server->run(); }};
    service->tell(
        {.name = "hello", .data = {{"results", (folder.path() / "results").string()}}, .seq = 0, .time = {}});
  }
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;
  ~RunningServer() {
    server->stop();
    thread.join();
  }

  [[nodiscard]] WebClient client() const { return WebClient{server->port()}; }
  [[nodiscard]] WebReply get(const std::string& path, const std::string& headers = k_session) const {
    return client().ask("GET", path, headers);
  }
  [[nodiscard]] std::size_t asked() const { return service->asked().size(); }
  /// It lives and answers.
  void check_alive() const { LONGS_EQUAL(200, get("/api/v1/state").status); }

  test::TemporaryFolder folder;
  MadeService* service{nullptr};
  std::unique_ptr<WebServer> server;
  std::thread thread;
};

void check_refused(int status, const char* code, const WebReply& reply) {
  LONGS_EQUAL(status, reply.status);
  const Json body = Json::parse(reply.body, nullptr, false);
  CHECK_TEXT(body.is_object() && body.contains("error"), reply.body.c_str());
  STRCMP_EQUAL(code, body["error"]["code"].get<std::string>().c_str());
  CHECK(!body["error"]["message"].get<std::string>().empty());
}

}  // namespace

TEST_GROUP(WebServer){};

TEST(WebServer, RequestsGoToTheServiceAndAnswersComeBack) {
  const RunningServer sut;
  const WebReply reply =
      sut.client().ask("POST", "/api/v1/scans/scan-0003/accept?x=a%20b", k_session, R"({"why":"good"})");
  LONGS_EQUAL(200, reply.status);
  const Json body = Json::parse(reply.body);
  STRCMP_EQUAL("/api/v1/scans/scan-0003/accept", body["path"].get<std::string>().c_str());
  STRCMP_EQUAL("a b", body["query"]["x"].get<std::string>().c_str());
  STRCMP_EQUAL("good", body["body"]["why"].get<std::string>().c_str());
  const control::Request asked = sut.service->asked().back();
  STRCMP_EQUAL("viewer-token", asked.token.c_str());
  STRCMP_EQUAL("web", asked.door.c_str());
  CHECK(asked.local);
  STRCMP_EQUAL("text/csv; charset=utf-8", sut.get("/api/v1/history.csv").header("content-type").c_str());
}

TEST(WebServer, EveryAnswerCarriesTheSafetyHeaders) {
  const RunningServer sut;
  for (const char* path :
       {"/", "/app.js", "/api/v1/state", "/api/v1/scans/scan-0001/files/line.csv", "/none", "/metrics"}) {
    const WebReply reply = sut.get(path);
    STRCMP_EQUAL("nosniff", reply.header("x-content-type-options").c_str());
    STRCMP_EQUAL("DENY", reply.header("x-frame-options").c_str());
    STRCMP_CONTAINS("default-src 'none'", reply.header("content-security-policy").c_str());
    CHECK(reply.header("content-security-policy").find("unsafe") == std::string::npos);
  }
  STRCMP_EQUAL("no-store", sut.get("/api/v1/state").header("cache-control").c_str());
  // A result's own page runs its scripts, but apart from the session.
  const WebReply page = sut.get("/api/v1/scans/scan-0001/files/path/tracking.html");
  STRCMP_CONTAINS("sandbox allow-scripts;", page.header("content-security-policy").c_str());
  CHECK(page.header("content-security-policy").find("allow-same-origin") == std::string::npos);
}

TEST(WebServer, WithoutASessionNothingIsToldOrDone) {
  const RunningServer sut;
  for (const char* path :
       {"/api/v1/state", "/api/v1/scans", "/api/v1/scans/scan-0001/files", "/metrics", "/api/v1/users",
        "/api/v1/scans/scan-0001/files/line.csv", "/api/v1/events", "/api/v1/live", "/foxglove"}) {
    check_refused(401, "login_needed", sut.get(path, ""));
  }
  for (const char* headers :
       {"Authorization: Bearer other-token\r\n", "Cookie: biteline_session=other\r\n"}) {
    for (const char* path :
         {"/api/v1/state", "/api/v1/scans/scan-0001/files/line.csv", "/metrics", "/api/v1/live"}) {
      check_refused(401, "login_needed", sut.get(path, headers));
    }
  }
  check_refused(401, "login_needed", sut.client().upgrade("/api/v1/live"));
  LONGS_EQUAL(200, sut.get("/api/v1/openapi.yaml", "").status);
  LONGS_EQUAL(200, sut.get("/", "").status);
}

TEST(WebServer, StopNeedsNoSessionOnTheCellsOwnMachineOnly) {
  const RunningServer sut;
  for (const char* path : {"/api/v1/commands/stop", "/api/v1/commands/laser-off"}) {
    LONGS_EQUAL(200, sut.client().ask("POST", path).status);
    for (const char* proxied :
         {"X-Forwarded-For: 192.0.2.7\r\n", "Forwarded: for=192.0.2.7\r\n", "Via: 1.1 proxy\r\n"}) {
      check_refused(401, "login_needed", sut.client().ask("POST", path, proxied));
    }
    check_refused(403, "origin_refused", sut.client().ask("POST", path, "Origin: http://evil.example\r\n"));
  }
  check_refused(401, "login_needed", sut.client().ask("POST", "/api/v1/commands/start"));
}

TEST(WebServer, ALoginGivesATokenOrACookieThatNoScriptReads) {
  const RunningServer sut;
  const WebReply token = sut.client().ask("POST", "/api/v1/sessions", "", k_login);
  LONGS_EQUAL(201, token.status);
  STRCMP_EQUAL("viewer-token", Json::parse(token.body)["token"].get<std::string>().c_str());
  STRCMP_EQUAL("", token.header("set-cookie").c_str());

  const WebReply cookie = sut.client().ask("POST", "/api/v1/sessions", "",
                                           R"({"name":"ada","password":"correct horse","cookie":true})");
  LONGS_EQUAL(201, cookie.status);
  CHECK(cookie.body.find("viewer-token") == std::string::npos);
  STRCMP_EQUAL("biteline_session=viewer-token; Path=/; HttpOnly; SameSite=Strict",
               cookie.header("set-cookie").c_str());
  CHECK(!sut.service->asked().back().body.contains("cookie"));
  LONGS_EQUAL(200, sut.get("/api/v1/state", "Cookie: biteline_session=viewer-token\r\n").status);
  const WebReply out =
      sut.client().ask("DELETE", "/api/v1/sessions", "Cookie: biteline_session=viewer-token\r\n");
  LONGS_EQUAL(204, out.status);
  STRCMP_CONTAINS("Max-Age=0", out.header("set-cookie").c_str());
}

TEST(WebServer, GuessingPasswordsIsSlowedDown) {
  const RunningServer sut;
  for (int i = 0; i < 5; ++i) {
    LONGS_EQUAL(
        401,
        sut.client().ask("POST", "/api/v1/sessions", "", R"({"name":"ada","password":"wrong one"})").status);
  }
  const std::size_t asked = sut.asked();
  const WebReply reply = sut.client().ask("POST", "/api/v1/sessions", "", k_login);
  check_refused(429, "too_many", reply);
  STRCMP_EQUAL("6", reply.header("retry-after").c_str());
  LONGS_EQUAL(asked, sut.asked());
}

TEST(WebServer, OtherHostsAndOriginsAreRefused) {
  const RunningServer sut;
  const std::string post = "POST /api/v1/commands/start HTTP/1.1\r\n" + k_session;
  for (const char* host : {"evil.example", "localhost.evil.example", "169.254.169.254"}) {
    WebClient client = sut.client();
    client.send(post + "Host: " + host + "\r\n\r\n");
    check_refused(421, "other_host", client.receive());
  }
  for (const char* hosts : {"", "Host: localhost\r\nHost: localhost\r\n"}) {
    WebClient client = sut.client();
    client.send(post + hosts + "\r\n");
    check_refused(400, "bad_request", client.receive());
  }
  for (const char* header : {"Origin: http://evil.example\r\n", "Origin: null\r\n",
                             "Origin: https://localhost\r\n", "Origin: http://localhost:1\r\n",
                             "Sec-Fetch-Site: cross-site\r\n", "Sec-Fetch-Site: same-site\r\n"}) {
    check_refused(403, "origin_refused",
                  sut.client().ask("POST", "/api/v1/commands/start", k_session + header));
    check_refused(403, "origin_refused", sut.client().upgrade("/api/v1/live", k_session + header));
  }
  LONGS_EQUAL(0, sut.asked());
  LONGS_EQUAL(
      200,
      sut.client().ask("POST", "/api/v1/commands/start", k_session + "Origin: http://localhost\r\n").status);
}

TEST(WebServer, FilesComeWholeInPartsAndNeverFromElsewhere) {
  const RunningServer sut;
  const std::string file = "/api/v1/scans/scan-0001/files/line.csv";
  STRCMP_EQUAL("0123456789", sut.get(file).body.c_str());
  const WebReply part = sut.get(file, k_session + "Range: bytes=2-4\r\n");
  LONGS_EQUAL(206, part.status);
  STRCMP_EQUAL("234", part.body.c_str());
  STRCMP_EQUAL("bytes 2-4/10", part.header("content-range").c_str());
  check_refused(416, "range_refused", sut.get(file, k_session + "Range: bytes=10-\r\n"));
  for (const char* path :
       {"/api/v1/scans/scan-0001/files/../../secret", "/api/v1/scans/scan-0001/files/%2e%2e/%2e%2e/secret",
        "/api/v1/scans/scan-0001/files/..%2f..%2fsecret", "/api/v1/scans/../files/secret", "/../secret",
        "/%2e%2e/secret", "//etc/passwd", "/api/v1/scans/scan-0001/files//etc/passwd"}) {
    const WebReply reply = sut.get(path);
    CHECK_TEXT(reply.status == 400 || reply.status == 404, path);
    CHECK(reply.body.find("hidden words") == std::string::npos);
  }
  std::filesystem::create_symlink("../../secret", sut.folder.path() / "results/scan-0001/link");
  check_refused(404, "not_found", sut.get("/api/v1/scans/scan-0001/files/link"));
  const Json list = Json::parse(sut.get("/api/v1/scans/scan-0001/files").body);
  LONGS_EQUAL(2, list["files"].size());
  check_refused(404, "not_found", sut.get("/api/v1/scans/scan-0009/files"));
  check_refused(404, "not_found", sut.get("/api/v1/scans/results/files"));
}

TEST(WebServer, WrongMethodsAndPathsSaySo) {
  const RunningServer sut;
  const WebReply reply = sut.client().ask("DELETE", "/api/v1/state", k_session);
  check_refused(405, "method_not_allowed", reply);
  STRCMP_EQUAL("GET", reply.header("allow").c_str());
  check_refused(404, "not_found", sut.get("/api/v1/nothing"));
  check_refused(405, "method_not_allowed", sut.client().ask("POST", "/", k_session));
  check_refused(426, "upgrade_needed", sut.get("/api/v1/live"));
  check_refused(400, "bad_request", sut.get("/api/v1/state?a=1&a=2"));
  WebClient text = sut.client();
  text.send("POST /api/v1/control HTTP/1.1\r\nHost: localhost\r\n" + k_session +
            "Content-Type: text/plain\r\nContent-Length: 2\r\n\r\n{}");
  check_refused(415, "wrong_type", text.receive());
  for (const char* body : {"{", "[]", "3", "{\"a\":}", "\xff\xfe"}) {
    check_refused(400, "bad_request", sut.client().ask("POST", "/api/v1/control", k_session, body));
  }
  check_refused(400, "bad_request",
                sut.client().ask("POST", "/api/v1/control", k_session, std::string(5000, '[')));
}

TEST(WebServer, TooMuchIsRefusedAndTheNextIsServed) {
  const RunningServer sut;
  check_refused(431, "header_too_large", sut.get("/api/v1/state", "X: " + std::string(9000, 'x') + "\r\n"));
  check_refused(413, "too_large",
                sut.client().ask("POST", "/api/v1/control", k_session, std::string(300'000, ' ')));
  WebClient chunked = sut.client();
  chunked.send("POST /api/v1/control HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n" +
               k_session + "\r\n");
  for (int i = 0; i < 80; ++i) chunked.send("1000\r\n" + std::string(4096, ' ') + "\r\n");
  check_refused(413, "too_large", chunked.receive());
  sut.check_alive();
}

TEST(WebServer, WhoIsSlowIsToldAndHoldsNobodyUp) {
  const RunningServer sut{{.request_time = std::chrono::milliseconds{300}}};
  WebClient slow = sut.client();
  slow.send("GET /api/v1/state HTTP/1.1\r\nHost: loc");
  sut.check_alive();
  check_refused(408, "too_slow", slow.receive());
  CHECK(!slow.frame());  // and it was ended
}

TEST(WebServer, MoreConnectionsThanAllowedAreTurnedAway) {
  const RunningServer sut{{.connections = 4}};
  std::vector<WebClient> held;
  for (int i = 0; i < 4; ++i) {
    held.push_back(sut.client());
    LONGS_EQUAL(200, held.back().ask("GET", "/api/v1/state", k_session).status);
  }
  check_refused(503, "too_busy", sut.get("/api/v1/state"));
  held.clear();
  // The server sees their end when its loop comes to it.
  for (int i = 0; i < 1000 && sut.get("/api/v1/state").status != 200; ++i) std::this_thread::yield();
  sut.check_alive();
}

TEST(WebServer, AServiceThatIsAwayIsToldInWordsAndBackByItself) {
  const RunningServer sut;
  sut.service->go(true);
  check_refused(503, "host_away", sut.get("/api/v1/state"));
  check_refused(503, "host_away", sut.client().ask("POST", "/api/v1/commands/stop"));
  check_refused(503, "host_away", sut.get("/api/v1/scans/scan-0001/files/line.csv"));
  LONGS_EQUAL(200, sut.get("/").status);
  sut.service->go(false);
  sut.check_alive();
}

TEST(WebServer, EventsReachEveryListener) {
  const RunningServer sut;
  WebClient listener = sut.client();
  LONGS_EQUAL(101, listener.upgrade("/api/v1/events", k_session).status);
  // The listener is in the list once the answer to a later request has come.
  sut.check_alive();
  sut.service->tell(
      {.name = "state", .data = {{"now", "scanning"}}, .seq = 7, .time = "2026-01-01T00:00:00.000Z"});
  const auto frame = listener.frame();
  CHECK(frame.has_value());
  LONGS_EQUAL(1, frame->opcode);
  const Json event = Json::parse(frame->content);
  STRCMP_EQUAL("state", event["event"].get<std::string>().c_str());
  LONGS_EQUAL(7, event["seq"].get<int>());
}

TEST(WebServer, FoxglovesClientsAreServedUnderBothNames) {
  const RunningServer sut;
  for (const char* name : {"foxglove.websocket.v1", "foxglove.sdk.v1"}) {
    WebClient client = sut.client();
    const WebReply reply = client.upgrade(
        "/foxglove?token=viewer-token",
        "Origin: https://app.example\r\nSec-WebSocket-Protocol: " + std::string{name} + "\r\n");
    LONGS_EQUAL(101, reply.status);
    STRCMP_EQUAL(name, reply.header("sec-websocket-protocol").c_str());
    STRCMP_EQUAL("serverInfo", Json::parse(client.frame()->content)["op"].get<std::string>().c_str());
    STRCMP_EQUAL("advertise", Json::parse(client.frame()->content)["op"].get<std::string>().c_str());
    // Masked as a client's frames must be (RFC 6455, 5.3), by zeros.
    const std::string wish = R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]})";
    client.send("\x81" + std::string(1, static_cast<char>(0x80 | wish.size())) + std::string(4, '\0') + wish);
    std::optional<WebClient::Frame> frame;
    for (std::uint32_t i = 0; !frame && i < 1000; ++i) {
      sut.server->publish(LiveKind::Picture,
                          picture_message({.sequence = i, .time_ns = i}, std::vector<std::uint8_t>(9, 7)));
      if (client.readable(20)) frame = client.frame();
    }
    CHECK(frame.has_value());
    LONGS_EQUAL(2, frame->opcode);
    LONGS_EQUAL(1, frame->content[0]);
    LONGS_EQUAL(5, frame->content[1]);
  }
  check_refused(401, "login_needed", sut.client().upgrade("/foxglove?token=other-token"));
}

TEST(WebServer, AWatcherWhoseSessionEndsIsSentAway) {
  const RunningServer sut{{.session_check = std::chrono::milliseconds{50}}};
  WebClient watcher = sut.client();
  LONGS_EQUAL(101, watcher.upgrade("/api/v1/live", k_session).status);
  sut.service->end_session();
  const auto frame = watcher.frame();
  CHECK(frame.has_value());
  LONGS_EQUAL(8, frame->opcode);
}

TEST(WebServer, TwentyWatchersAndOneThatNeverReads) {
  const RunningServer sut;
  std::vector<WebClient> watchers;
  for (int i = 0; i < 20; ++i) {
    watchers.push_back(sut.client());
    LONGS_EQUAL(101, watchers.back().upgrade("/api/v1/live", k_session).status);
  }
  WebClient& silent = watchers.front();
  // More than what any socket buffer holds, so that the silent one is surely behind.
  constexpr int k_pictures = 400;
  const std::vector<std::uint8_t> jpeg(200'000, 0x55);
  std::vector<std::thread> readers;
  std::atomic<int> got_last{0};
  for (std::size_t i = 1; i < watchers.size(); ++i) {
    readers.emplace_back([&, i] {
      while (const auto frame = watchers[i].frame()) {
        if (frame->opcode != 2) continue;
        std::uint32_t sequence = 0;
        std::memcpy(&sequence, frame->content.data() + 1, sizeof sequence);
        if (sequence == k_pictures) {
          ++got_last;
          return;
        }
      }
    });
  }
  for (std::uint32_t i = 1; i <= k_pictures; ++i) {
    sut.server->publish(LiveKind::Picture, picture_message({.sequence = i, .time_ns = i}, jpeg));
  }
  for (std::thread& reader : readers) reader.join();
  LONGS_EQUAL(19, got_last);
  sut.check_alive();
  // The silent one wakes up: it has missed pictures, and the newest is the last that it gets.
  int frames = 0;
  std::uint32_t sequence = 0;
  while (sequence != k_pictures) {
    const auto frame = silent.frame();
    CHECK(frame.has_value());
    if (frame->opcode != 2) continue;
    std::uint32_t next = 0;
    std::memcpy(&next, frame->content.data() + 1, sizeof next);
    CHECK(next > sequence);
    sequence = next;
    ++frames;
  }
  CHECK(frames < k_pictures);
}

TEST(WebServer, TenThousandGarbledRequestsHarmNothing) {
  const RunningServer sut;
  const std::vector<std::string> sound{
      "GET /api/v1/state HTTP/1.1\r\nHost: localhost\r\n" + k_session + "\r\n",
      "POST /api/v1/control HTTP/1.1\r\nHost: localhost\r\n" + k_session +
          "Content-Type: application/json\r\nContent-Length: 17\r\n\r\n{\"action\":\"take\"}",
      "GET /api/v1/scans/scan-0001/files/line.csv HTTP/1.1\r\nHost: localhost\r\nRange: bytes=1-3\r\n" +
          k_session + "\r\n",
      "GET /api/v1/live HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
          k_session + "\r\n\x81\x85mask12345",
      "POST /api/v1/control HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n" + k_session +
          "Content-Type: application/json\r\n\r\n11\r\n{\"action\":\"take\"}\r\n0\r\n\r\n"};
  std::mt19937 random{20260715};
  const auto below = [&random](std::size_t bound) { return random() % bound; };
  int refused = 0;
  for (int i = 0; i < 10'000; ++i) {
    std::string text = sound[below(sound.size())];
    for (std::size_t changes = 1 + below(8); changes > 0 && !text.empty(); --changes) {
      const std::size_t at = below(text.size());
      switch (below(5)) {
        case 0:
          text[at] = static_cast<char>(random());
          break;
        case 1:
          text.erase(at, 1 + below(20));
          break;
        case 2:
          text.insert(at, 1 + below(20), static_cast<char>(random()));
          break;
        case 3:
          text.insert(at, text.substr(below(text.size()), below(40)));
          break;
        default:
          text.resize(std::max<std::size_t>(1, at));
          break;
      }
    }
    WebClient client = sut.client();
    client.send(text);
    // Nothing more comes: what is cut off is given up at once and not after the time limit.
    shutdown(client.fd(), SHUT_WR);
    const WebReply reply = client.receive();
    CHECK_TEXT(reply.status == 0 || (reply.status >= 101 && reply.status < 500), text.c_str());
    if (reply.status >= 400) ++refused;
  }
  CHECK(refused > 1000);
  sut.check_alive();
  // Whatever got through was a request of the table, by whom it said.
  for (const control::Request& request : sut.service->asked()) CHECK(request.path.starts_with("/api/v1/"));
}

TEST(WebServer, TheExamplesOfTheDocumentRun) {
  if (std::system("command -v curl >/dev/null && command -v python3 >/dev/null") != 0) {
    std::puts("skipped: the examples need curl and python3");
    return;
  }
  const RunningServer sut;
  std::ifstream document{std::filesystem::path{BITELINE_DOCUMENTS} / "cockpit.md"};
  std::map<std::string, std::string> examples;
  std::string kind;
  for (std::string line; std::getline(document, line);) {
    if (line.starts_with("```")) {
      kind = kind.empty() ? line.substr(3) + " " : "";
    } else if (!kind.empty()) {
      examples[kind] += line + "\n";
    }
  }
  const std::string setting = "cd " + sut.folder.path().string() + " && BITELINE=" + sut.server->address() +
                              " BITELINE_NAME=ada BITELINE_PASSWORD='correct horse' ";
  const std::pair<const char*, const char*> programs[]{{"sh ", "sh -eu"}, {"python ", "python3"}};
  for (const auto& [name, program] : programs) {
    const auto file = sut.folder.write(name, examples[name]);
    LONGS_EQUAL(0, std::system((setting + program + " '" + file.string() + "' >out").c_str()));
    std::ifstream out{sut.folder.path() / "out"};
    const std::string said{std::istreambuf_iterator<char>{out}, {}};
    STRCMP_CONTAINS("scan-0001", said.c_str());
  }
  CHECK(std::filesystem::file_size(sut.folder.path() / "line.csv") == 10);
}

TEST(WebServer, WithACertificateItServesTlsAndNothingOlder) {
  if (std::system("command -v curl >/dev/null && command -v openssl >/dev/null") != 0) {
    std::puts("skipped: TLS needs curl and openssl");
    return;
  }
  const test::TemporaryFolder keys;
  const std::string folder = keys.path().string();
  const std::string made =
      "cd " + folder +
      " && openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout key.pem "
      "-out certificate.pem -days 2 -subj /CN=localhost -addext subjectAltName=DNS:localhost "
      ">/dev/null 2>&1";
  LONGS_EQUAL(0, std::system(made.c_str()));
  const RunningServer sut{
      {}, TlsFiles{.certificate = keys.path() / "certificate.pem", .key = keys.path() / "key.pem"}};
  const std::string curl = "cd " + folder + " && curl -s --max-time 60 --cacert certificate.pem ";
  const std::string place = "https://localhost:" + std::to_string(sut.server->port());
  const auto said = [&keys] {
    std::ifstream out{keys.path() / "out"};
    return std::string{std::istreambuf_iterator<char>{out}, {}};
  };
  LONGS_EQUAL(0, std::system((curl + "-D - " + place + "/ >out").c_str()));
  STRCMP_CONTAINS("Strict-Transport-Security", said().c_str());
  STRCMP_CONTAINS("<title>page</title>", said().c_str());
  const std::string login =
      R"(-H 'Content-Type: application/json' -d '{"name":"ada","password":"correct horse","cookie":true}' )";
  LONGS_EQUAL(0, std::system((curl + login + "-D - " + place + "/api/v1/sessions >out").c_str()));
  STRCMP_CONTAINS("SameSite=Strict; Secure", said().c_str());
  // The live data over TLS: the socket is opened and stays open until curl gives up.
  const std::string upgrade =
      "-N --max-time 1 --http1.1 -D - -H 'Authorization: Bearer viewer-token' -H 'Connection: Upgrade' "
      "-H 'Upgrade: websocket' -H 'Sec-WebSocket-Version: 13' -H 'Sec-WebSocket-Key: "
      "dGhlIHNhbXBsZSBub25jZQ==' ";
  std::system((curl + upgrade + place + "/api/v1/events >out").c_str());
  STRCMP_CONTAINS("101 Switching Protocols", said().c_str());
  CHECK(std::system((curl + "--tls-max 1.1 " + place + "/ >out").c_str()) != 0);
  // Who speaks no TLS gets no answer, and holds nobody up.
  CHECK(sut.client().ask("GET", "/").status == 0);
  LONGS_EQUAL(0, std::system((curl + place + "/ >out").c_str()));
}

TEST(WebServer, BeyondLoopbackItWantsTls) {
  WebConfig config;
  config.port = 0;
  config.address = "0.0.0.0";
  FAILS_NAMING(Errc::AuthenticationFailed, "--certificate", WebServer::open(config, closed_service_door()));
  config.address = "example.org";
  FAILS_NAMING(Errc::InvalidArgument, "example.org", WebServer::open(config, closed_service_door()));
  config.address = "127.0.0.1";
  config.tls = TlsFiles{.certificate = "/none.pem", .key = "/none.key"};
  FAILS_NAMING(Errc::FileUnreadable, "none.pem", WebServer::open(config, closed_service_door()));
}

TEST(WebServer, APortThatIsTakenIsTold) {
  const RunningServer sut;
  WebConfig config;
  config.port = sut.server->port();
  FAILS_NAMING(Errc::PeerRefused, "--listen", WebServer::open(config, closed_service_door()));
}

}  // namespace biteline::web
