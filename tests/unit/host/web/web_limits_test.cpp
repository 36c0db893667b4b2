// SPDX-License-Identifier: MIT
// What is too much, too slow or garbled: refused, and the next one is served.
#include <CppUTest/TestHarness.h>

#include <atomic>
#include <random>
#include <thread>

#include "tests/unit/host/web/running_server.hpp"

namespace biteline::web {

TEST_GROUP(WebLimits){};

TEST(WebLimits, TooMuchIsRefusedAndTheNextIsServed) {
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

TEST(WebLimits, WhoIsSlowIsToldAndHoldsNobodyUp) {
  const RunningServer sut{{.request_time = std::chrono::milliseconds{300}}};
  WebClient slow = sut.client();
  slow.send("GET /api/v1/state HTTP/1.1\r\nHost: loc");
  sut.check_alive();
  check_refused(408, "too_slow", slow.receive());
  CHECK(!slow.frame());  // and it was ended
}

TEST(WebLimits, AWatcherStaysLongerThanARequestMayTake) {
  constexpr std::chrono::milliseconds k_request_time{200};
  const RunningServer sut{{.request_time = k_request_time}};
  WebClient events = sut.client();
  LONGS_EQUAL(101, events.upgrade("/api/v1/events", k_session).status);
  std::this_thread::sleep_for(5 * k_request_time);
  sut.service->tell({.name = "state", .data = {{"phase", "scanning"}}, .seq = 1, .time = control::utc_now()});
  const auto frame = events.frame();
  CHECK(frame && frame->content.find("scanning") != std::string::npos);
}

TEST(WebLimits, MoreConnectionsThanAllowedAreTurnedAway) {
  const RunningServer sut{{.connections = 4, .kept_for_local = 0}};
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

TEST(WebLimits, SilentConnectionsShutNobodyOut) {
  const RunningServer sut{{.connections = 16, .connections_an_address = 8}};
  for (const std::string& begin :
       {std::string{}, std::string{"G"}, std::string{"POST /api/v1/commands/stop HTTP/1.1\r\nHost: local"},
        std::string{"POST /api/v1/control HTTP/1.1\r\nHost: localhost\r\nContent-Length: 900\r\n\r\n{"}}) {
    std::vector<WebClient> held;
    for (int i = 0; i < 40; ++i) {
      held.push_back(sut.client());
      held.back().send(begin);
    }
    LONGS_EQUAL(200, sut.client().ask("POST", "/api/v1/commands/stop").status);
    sut.check_alive();
  }
}

TEST(WebLimits, WhoAsksWithoutASessionAndStaysShutsNobodyOut) {
  const RunningServer sut{{.connections = 16, .connections_an_address = 8}};
  WebClient session = sut.client();
  LONGS_EQUAL(200, session.ask("GET", "/api/v1/state", k_session).status);
  std::vector<WebClient> held;
  for (int i = 0; i < 40; ++i) {
    held.push_back(sut.client());
    LONGS_EQUAL(200, held.back().ask("GET", "/", "Authorization: Bearer made-up\r\n").status);
  }
  LONGS_EQUAL(200, sut.client().ask("POST", "/api/v1/commands/stop").status);
  // Who has logged in keeps the connection all the while.
  LONGS_EQUAL(200, session.ask("GET", "/api/v1/state", k_session).status);
}

TEST(WebLimits, ThisMachinesStopFindsRoomAmongSessions) {
  const RunningServer sut{{.connections = 8}};
  std::vector<WebClient> held;
  for (int i = 0; i < 8; ++i) {
    held.push_back(sut.client());
    LONGS_EQUAL(101, held.back().upgrade("/api/v1/events", k_session).status);
  }
  LONGS_EQUAL(200, sut.client().ask("POST", "/api/v1/commands/stop").status);
  for (WebClient& one : held) CHECK(!one.readable(0));
}

TEST(WebLimits, WhoSaysNothingIsEndedSoon) {
  const RunningServer sut{{.first_time = std::chrono::milliseconds{200}}};
  WebClient silent = sut.client();
  LONGS_EQUAL(0, silent.receive().status);
  // Between two requests there is more time.
  WebClient slow = sut.client();
  LONGS_EQUAL(200, slow.ask("GET", "/api/v1/state", k_session).status);
  std::this_thread::sleep_for(std::chrono::milliseconds{600});
  LONGS_EQUAL(200, slow.ask("GET", "/api/v1/state", k_session).status);
}

TEST(WebLimits, ABodyWhoseEndIsNotToldInAKnownWayIsRefusedAndTheConnectionEnds) {
  const RunningServer sut;
  const std::string smuggled = "GET /api/v1/state HTTP/1.1\r\nHost: localhost\r\n" + k_session + "\r\n";
  for (const char* coding :
       {"Transfer-Encoding: xchunked\r\n", "Transfer-Encoding: gzip\r\n",
        "Transfer-Encoding: gzip, chunked\r\n", "Transfer-Encoding: chunked, identity\r\n",
        "Transfer-Encoding: identity\r\n", "Transfer-Encoding:\r\n",
        "Transfer-Encoding: chunked\r\nTransfer-Encoding: x\r\n", "Transfer-Encoding: \"chunked\"\r\n",
        "Transfer-Encoding: chunked\r\nContent-Length: 4\r\n",
        "Content-Length: 4\r\nTransfer-Encoding: chunked\r\n", "Content-Length: 4\r\nContent-Length: 5\r\n",
        "Content-Length: -1\r\n"}) {
    WebClient client = sut.client();
    client.send(std::string{"POST /api/v1/commands/stop HTTP/1.1\r\nHost: localhost\r\n"} + coding + "\r\n" +
                smuggled);
    const WebReply first = client.receive();
    CHECK_TEXT(first.status == 400 || first.status == 501, coding);
    LONGS_EQUAL_TEXT(0, client.receive().status, coding);
  }
  WebClient old = sut.client();
  old.send(
      "POST /api/v1/commands/stop HTTP/1.0\r\nHost: localhost\r\nTransfer-Encoding: "
      "chunked\r\n\r\n0\r\n\r\n" +
      smuggled);
  CHECK(old.receive().status >= 400);
  LONGS_EQUAL(0, old.receive().status);
  LONGS_EQUAL(0, sut.asked());
  sut.check_alive();
}

TEST(WebLimits, TwentyWatchersAndOneThatNeverReads) {
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

TEST(WebLimits, TenThousandGarbledRequestsHarmNothing) {
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
    // 501: a Transfer-Encoding that is not known.
    CHECK_TEXT(reply.status == 0 || (reply.status >= 101 && reply.status < 500) || reply.status == 501,
               text.c_str());
    if (reply.status >= 400) ++refused;
  }
  CHECK(refused > 1000);
  sut.check_alive();
  // Whatever got through was a request of the table, by whom it said.
  for (const control::Request& request : sut.service->asked()) CHECK(request.path.starts_with("/api/v1/"));
}

TEST(WebLimits, GuessingPasswordsIsSlowedDown) {
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

}  // namespace biteline::web
