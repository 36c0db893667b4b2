// SPDX-License-Identifier: MIT
// The server against a made service: what it lets through and what it refuses.
#include "host/apps/biteline-web/web_server.hpp"

#include <CppUTest/TestHarness.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>

#include "tests/unit/host/web/running_server.hpp"

namespace biteline::web {

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

TEST(WebServer, AnotherOriginGetsNothingByACookie) {
  const RunningServer sut;
  const std::string cookie = "Cookie: biteline_session=viewer-token\r\n";
  for (const char* origin :
       {"Origin: http://localhost:9999\r\nSec-Fetch-Site: same-site\r\n", "Origin: http://evil.example\r\n",
        "Origin: null\r\n", "Sec-Fetch-Site: same-site\r\n",
        "Origin: http://localhost:9999\r\nSec-Fetch-Mode: navigate\r\n", "Origin: https://localhost\r\n"}) {
    for (const char* path : {"/foxglove", "/foxglove?x", "/foxglove?x=1", "/foxglove?token=", "/%66oxglove?x",
                             "/api/v1/live", "/api/v1/live?x", "/api/v1/events", "/metrics", "/metrics?x"}) {
      const WebReply reply = sut.client().upgrade(path, cookie + origin);
      CHECK_TEXT(reply.status == 401 || reply.status == 403, path);
    }
    for (const char* path : {"/api/v1/state", "/metrics", "/api/v1/scans/scan-0001/files/line.csv",
                             "/foxglove", "/api/v1/openapi.yaml"}) {
      const WebReply reply = sut.get(path, cookie + origin);
      CHECK_TEXT(reply.status == 401 || reply.status == 403, path);
    }
    // The token in the address is what a Foxglove client shows.
    LONGS_EQUAL_TEXT(101, sut.client().upgrade("/foxglove?token=viewer-token", origin).status, origin);
    CHECK(sut.client().upgrade("/foxglove?token=made-up", cookie + origin).status == 401);
    CHECK(sut.client().upgrade("/foxglove", k_session + origin).status == 401);
  }
  // Of its own origin the cookie counts, and a link from elsewhere leads to the page.
  LONGS_EQUAL(101, sut.client().upgrade("/foxglove", cookie + "Origin: http://localhost\r\n").status);
  LONGS_EQUAL(200, sut.get("/", "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\n").status);
}

TEST(WebServer, TheFirstAccountIsAskedForWithWhatOnlyTheServicesUserCanRead) {
  const RunningServer sut;
  sut.folder.write("results/.first.token", "the token\n");
  const std::string body = R"({"name":"ada","role":"administrator","password":"correct horse"})";
  sut.client().ask("POST", "/api/v1/users", "", body);
  STRCMP_EQUAL("the token", sut.service->asked().back().token.c_str());
  CHECK(sut.service->asked().back().local);
  // Not for another path, and no session gives way to it.
  sut.client().ask("POST", "/api/v1/commands/stop");
  STRCMP_EQUAL("", sut.service->asked().back().token.c_str());
  sut.client().ask("POST", "/api/v1/users", k_session, body);
  STRCMP_EQUAL("viewer-token", sut.service->asked().back().token.c_str());
  // Nor is it a file of the results.
  CHECK(sut.get("/api/v1/scans/../files/.first.token", k_session).status >= 400);
}

TEST(WebServer, AHostWithAPortThatIsNoneIsRefused) {
  const RunningServer sut;
  for (const char* host :
       {"localhost:99999999", "localhost:65536", "localhost:0", "localhost:", "localhost:-1", "localhost:80x",
        "localhost:8080:1", "[::1]:99999", "[::1]x", "[::1"}) {
    WebClient client = sut.client();
    client.send(std::string{"GET /api/v1/state HTTP/1.1\r\n"} + k_session + "Host: " + host + "\r\n\r\n");
    check_refused(421, "other_host", client.receive());
  }
  for (const char* host : {"localhost", "localhost:8080", "LOCALHOST:65535", "127.0.0.1:1", "[::1]:443"}) {
    WebClient client = sut.client();
    client.send(std::string{"GET /api/v1/state HTTP/1.1\r\n"} + k_session + "Host: " + host + "\r\n\r\n");
    LONGS_EQUAL_TEXT(200, client.receive().status, host);
  }
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

TEST(WebServer, ThePageComesPackedAndOnlyWhenItChanged) {
  const RunningServer sut;
  sut.folder.write("page/app.js.gz", "packed");
  const char* const takes = "Accept-Encoding: br, gzip\r\n";
  const WebReply packed = sut.get("/app.js", takes);
  STRCMP_EQUAL("packed", packed.body.c_str());
  STRCMP_EQUAL("gzip", packed.header("content-encoding").c_str());
  STRCMP_EQUAL("Accept-Encoding", packed.header("vary").c_str());
  STRCMP_EQUAL("text/javascript; charset=utf-8", packed.header("content-type").c_str());
  for (const char* refuses : {"", "Accept-Encoding: br\r\n", "Accept-Encoding: gzip;q=0, br\r\n"}) {
    const WebReply plain = sut.get("/app.js", refuses);
    STRCMP_EQUAL("1;", plain.body.c_str());
    STRCMP_EQUAL("", plain.header("content-encoding").c_str());
    CHECK(plain.header("etag") != packed.header("etag"));
  }
  STRCMP_CONTAINS("page", sut.get("/", takes).body.c_str());  // nothing packed lies beside it

  const std::string known = "If-None-Match: " + packed.header("etag") + "\r\n";
  const WebReply unchanged = sut.get("/app.js", takes + known);
  LONGS_EQUAL(304, unchanged.status);
  STRCMP_EQUAL("", unchanged.body.c_str());
  STRCMP_EQUAL(packed.header("etag").c_str(), unchanged.header("etag").c_str());
  STRCMP_CONTAINS("default-src 'none'", unchanged.header("content-security-policy").c_str());
  LONGS_EQUAL(200, sut.get("/app.js", known).status);  // not the packed one
  sut.folder.write("page/app.js.gz", "packed anew");
  STRCMP_EQUAL("packed anew", sut.get("/app.js", takes + known).body.c_str());
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
    client.send(std::string("\x81").append(1, static_cast<char>(0x80 | wish.size())).append(4, '\0') + wish);
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

TEST(WebServer, APortThatIsTakenIsTold) {
  const RunningServer sut;
  WebConfig config;
  config.port = sut.server->port();
  FAILS_NAMING(Errc::PeerRefused, "--listen", WebServer::open(config, closed_service_door()));
}

}  // namespace biteline::web
