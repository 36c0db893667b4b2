// SPDX-License-Identifier: MIT
#include "host/fleet/metrics.hpp"

#include <CppUTest/TestHarness.h>

#include <cctype>
#include <chrono>
#include <fstream>
#include <iterator>
#include <set>

#include "tests/support/errors.hpp"
#include "tests/support/web_client.hpp"

namespace biteline::fleet {
namespace {

FleetNews made() {
  CellRow cell;
  cell.cell = "cell-1";
  cell.online = true;
  cell.heard_ms = 1'795'000'000'500;
  cell.waiting = 3;
  cell.ok = 10;
  cell.refused = 2;
  cell.last_shoe_ms = 1'795'000'000'000;
  return {.broker = true,
          .database = true,
          .taken = 12,
          .cells = {cell},
          .odd = {{.model = "a \"boot\"",
                   .odd = {.cell = "cell-1", .difference = Difference::Wider, .mm = -0.15}}}};
}

/// Names of metrics in a text, without labels.
std::set<std::string> names_in(const std::string& text) {
  std::set<std::string> names;
  const std::string front = "biteline_fleet_";
  for (std::size_t at = text.find(front); at != std::string::npos; at = text.find(front, at + 1)) {
    std::size_t end = at;
    while (end < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[end])) != 0 || text[end] == '_'))
      ++end;
    names.insert(text.substr(at, end - at));
  }
  return names;
}

}  // namespace

TEST_GROUP(FleetMetrics){};

TEST(FleetMetrics, TextHasEveryCellAndEscapesLabels) {
  const std::string text = metrics_text(made());
  for (const char* line :
       {"biteline_fleet_cell_online{cell=\"cell-1\"} 1\n", "biteline_fleet_cell_waiting{cell=\"cell-1\"} 3\n",
        "biteline_fleet_shoes_total{cell=\"cell-1\",verdict=\"refused\"} 2\n",
        "biteline_fleet_taken_total 12\n",
        "biteline_fleet_cell_heard_timestamp_seconds{cell=\"cell-1\"} 1795000000.5\n",
        "biteline_fleet_cell_odd_mm{cell=\"cell-1\",model=\"a \\\"boot\\\"\"} -0.14999999999999999\n"})
    STRCMP_CONTAINS(line, text.c_str());
}

TEST(FleetMetrics, ShippedRulesAndBoardAskForMetricsThatThereAre) {
  const std::set<std::string> there = names_in(metrics_text(made()));
  for (const char* shipped : {"/rules.yml", "/board.json"}) {
    std::ifstream file{std::string{BITELINE_PROMETHEUS} + shipped};
    const std::set<std::string> asked = names_in({std::istreambuf_iterator<char>{file}, {}});
    CHECK_TEXT(asked.size() >= 6, shipped);
    for (const std::string& name : asked) CHECK_TEXT(there.contains(name), name.c_str());
  }
}

TEST(FleetMetrics, NobodyReadsWithoutATokenAlsoOnLoopback) {
  const auto port = MetricsPort::open(0, [](const std::string& token) { return token == "abc"; });
  SUCCEEDS(port);
  (*port)->show("a 1\n");
  const auto ask = [&](const std::string& headers) {
    return test::WebClient{(*port)->port()}.ask("GET", "/metrics", headers);
  };
  for (const char* headers :
       {"", "Authorization: Bearer \r\n", "Authorization: Bearer abcd\r\n", "Authorization: Basic abc\r\n",
        "X-Authorization: Bearer abc\r\n", "Authorization: Bearer ab c\r\n"}) {
    const test::WebReply reply = ask(headers);
    LONGS_EQUAL_TEXT(401, reply.status, headers);
    CHECK_TEXT(reply.body.find("a 1") == std::string::npos, headers);
    STRCMP_EQUAL("Bearer", reply.header("www-authenticate").c_str());
  }
  LONGS_EQUAL(200, ask("Authorization: Bearer abc\r\n").status);
  LONGS_EQUAL(200, ask("authorization: bearer abc\r\n").status);
}

TEST(FleetMetrics, PortAnswersAndSlowOrWrongClientsHoldItUpForABoundedTime) {
  const auto port = MetricsPort::open(0, [](const std::string& token) { return token == "abc"; });
  SUCCEEDS(port);
  (*port)->show("a 1\n");
  const char* const token = "Authorization: Bearer abc\r\n";
  const test::WebReply reply = test::WebClient{(*port)->port()}.ask("GET", "/metrics", token);
  LONGS_EQUAL(200, reply.status);
  STRCMP_EQUAL("a 1\n", reply.body.c_str());
  LONGS_EQUAL(404, test::WebClient{(*port)->port()}.ask("GET", "/").status);
  const test::WebClient silent{(*port)->port()};
  const test::WebClient endless{(*port)->port()};
  endless.send(std::string(20'000, 'x'));
  LONGS_EQUAL(200, test::WebClient{(*port)->port()}.ask("GET", "/metrics", token).status);
  const auto taken = MetricsPort::open((*port)->port(), {});
  CHECK(!taken);
  CHECK(taken.error().code == Errc::PeerRefused);
}

}  // namespace biteline::fleet
