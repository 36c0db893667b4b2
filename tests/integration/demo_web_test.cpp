// SPDX-License-Identifier: MIT
// The demo with its page: an address with a one-time token, which lets one viewer look on and nothing more.
#include <CppUTest/TestHarness.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/web_client.hpp"

namespace biteline {
namespace {

using intake::ChildProcess;
using nlohmann::json;
using test::WebClient;
using test::WebReply;
using namespace std::chrono_literals;

constexpr auto k_patience = 240s;  // of a loaded machine

struct PageAddress {
  std::uint16_t port{0};
  std::string token;
};

/// "open http://127.0.0.1:PORT/#token=TOKEN"; port 0 when it ended first.
PageAddress address_of(ChildProcess& demo) {
  const std::string begin = "open http://127.0.0.1:", middle = "/#token=";
  while (const auto line = demo.next_line(k_patience)) {
    const std::size_t at = line->find(middle);
    if (!line->starts_with(begin) || at == std::string::npos) continue;
    return {.port = static_cast<std::uint16_t>(std::stoi(line->substr(begin.size()))),
            .token = line->substr(at + middle.size())};
  }
  return {};
}

}  // namespace

TEST_GROUP(DemoWeb) {
  test::TemporaryFolder folder;

  ChildProcess start(const std::string& address) const {
    auto demo =
        ChildProcess::start({.program = BITELINE_DEMO,
                             .arguments = {"--web", address, "--out", (folder.path() / "demo").string()},
                             .pass_stderr = true});
    SUCCEEDS(demo);
    return std::move(*demo);
  }
  /// Without Node and its packages the build has no page.
  static bool page_built() {
    const auto page =
        std::filesystem::path{BITELINE_DEMO}.parent_path().parent_path() / "share/biteline/web/app.js";
    if (std::filesystem::exists(page)) {
      test::note_ran();
      return true;
    }
    test::note_skipped("the page was not built: " + page.string());
    return false;
  }
  /// Reads events until the cell scans.
  static bool scans(WebClient & events) {
    while (const auto frame = events.frame()) {
      if (frame->opcode != 1) continue;
      const json event = test::read_json(frame->content);
      if (event.value("event", "") == "state" && event["data"].value("phase", "") == "scanning") return true;
    }
    return false;
  }
};

TEST(DemoWeb, TokenLetsOneViewerLookAndCommandNothing) {
  if (!page_built()) return;
  // A model of the user's own: no demo reads or writes there.
  folder.write("data/biteline/models/mine/report.json", "{}");
  ::setenv("XDG_DATA_HOME", (folder.path() / "data").c_str(), 1);
  ChildProcess demo = start("127.0.0.1:0");
  const PageAddress at = address_of(demo);
  CHECK(at.port != 0);
  WebClient client{at.port};
  STRCMP_CONTAINS("<script", client.ask("GET", "/").body.c_str());
  const std::string login = test::text_of(json{{"token", at.token}});
  const WebReply session = client.ask("POST", "/api/v1/sessions", "", login);
  LONGS_EQUAL(201, session.status);
  const json who = test::read_json(session.body);
  STRCMP_EQUAL("viewer", who["user"]["role"].get<std::string>().c_str());
  LONGS_EQUAL(401, client.ask("POST", "/api/v1/sessions", "", login).status);

  const std::string bearer = "Authorization: Bearer " + who["token"].get<std::string>() + "\r\n";
  LONGS_EQUAL(200, client.ask("GET", "/api/v1/state", bearer).status);
  LONGS_EQUAL(0, test::read_json(client.ask("GET", "/api/v1/models", bearer).body)["models"].size());
  LONGS_EQUAL(401, client.ask("GET", "/api/v1/state").status);
  WebClient events{at.port}, live{at.port};
  LONGS_EQUAL(101, events.upgrade("/api/v1/events", bearer).status);
  LONGS_EQUAL(101, live.upgrade("/api/v1/live", bearer).status);
  CHECK(scans(events));
  const auto piece = live.frame();
  CHECK(piece && piece->opcode == 2 && !piece->content.empty());

  for (const auto& [path, body] :
       {std::pair{"/control", R"({"action":"take"})"}, std::pair{"/commands/start", "{}"},
        std::pair{"/commands/rescan", "{}"}, std::pair{"/scans/scan-0001/accept", "{}"}}) {
    LONGS_EQUAL_TEXT(403, client.ask("POST", std::string{"/api/v1"} + path, bearer, body).status, path);
  }

  LONGS_EQUAL(0, kill(demo.pid(), SIGINT));
  const auto status = demo.wait(k_patience);
  SUCCEEDS(status);
  LONGS_EQUAL(0, *status);
  CHECK(!WebClient{at.port}.connected());
}

TEST(DemoWeb, TakenPortIsToldInOneLine) {
  if (!page_built()) return;
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  CHECK(bind(fd, reinterpret_cast<const sockaddr*>(&address), length) == 0 && listen(fd, 1) == 0);
  CHECK(getsockname(fd, reinterpret_cast<sockaddr*>(&address), &length) == 0);
  ChildProcess demo = start("127.0.0.1:" + std::to_string(ntohs(address.sin_port)));
  LONGS_EQUAL(0, address_of(demo).port);
  const auto status = demo.wait(k_patience);
  SUCCEEDS(status);
  CHECK(*status != 0);
  STRCMP_CONTAINS("say --web ADDRESS:PORT", demo.last_words().c_str());
  close(fd);
}

}  // namespace biteline
