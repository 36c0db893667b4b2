// SPDX-License-Identifier: MIT
// Stop waits for nothing: neither for the memory, nor for who says it, nor for its row in the log.
#include <sqlite3.h>

#include <atomic>
#include <future>

#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

using namespace std::chrono_literals;

TEST_GROUP_BASE(ApiStop, ApiWorld) {
  /// Another program that writes: the memory waits for it, and whoever waits for the memory.
  sqlite3* other{nullptr};
  std::future<void> waiting;
  std::atomic<bool> over{false};

  void lock_memory() {
    LONGS_EQUAL(SQLITE_OK, sqlite3_open((folder.path() / memory::k_memory_file).c_str(), &other));
    LONGS_EQUAL(SQLITE_OK, sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr));
    std::promise<void> begins;
    std::future<void> begun = begins.get_future();
    waiting = std::async(std::launch::async, [this, &begins] {
      begins.set_value();
      // Each waits for 2 s.
      for (int i = 0; i < 20 && !over; ++i) static_cast<void>(memory->put_setting("a", "b", {}));
    });
    begun.wait();
    // It holds the memory now, and waits for the other program.
    std::this_thread::sleep_for(200ms);
  }
  [[nodiscard]] bool memory_waits() const {
    return waiting.wait_for(0s) == std::future_status::timeout;
  }
  void free_memory() {
    over = true;
    sqlite3_exec(other, "ROLLBACK", nullptr, nullptr, nullptr);
    sqlite3_close(other);
    other = nullptr;
    waiting.wait();
  }
  void teardown() override {
    if (other != nullptr) free_memory();
  }
  std::optional<control::Answer> say(const std::string& path, const std::string& door = "web") {
    control::Request request;
    request.token = token;
    request.local = local;
    request.door = door;
    request.method = "POST";
    request.path = "/api/v1" + path;
    return sut.urgent(request);
  }
  /// The log's rows of stops, once there are so many.
  std::vector<memory::LogRow> stops_in_log(std::size_t count) {
    std::vector<memory::LogRow> stops;
    for (int i = 0; i < 600; ++i) {
      stops.clear();
      const auto rows = memory->log_rows(0, 100);
      if (rows) {
        for (const memory::LogRow& row : *rows)
          if (row.action == "stop" || row.action == "laser off") stops.push_back(row);
      }
      if (stops.size() >= count) break;
      std::this_thread::sleep_for(100ms);
    }
    return stops;
  }
};

TEST(ApiStop, ADeedOfAnybodyWhoMaySayItComesBeforeTheMemory) {
  log_in("ana");
  const std::string operators = token;
  lock_memory();
  const struct {
    const char* name;
    std::string token;
    bool local;
    const char* path;
    const char* did;
  } k_cases[] = {
      {"nobody at the cell", "", true, "/commands/stop", "stop somebody at the cell"},
      {"an operator at the cell", operators, true, "/commands/stop", "stop ana"},
      {"an operator elsewhere", operators, false, "/commands/stop", "stop ana"},
      {"an operator elsewhere", operators, false, "/commands/laser-off", "laser off ana"},
      {"a broken session at the cell", "no session", true, "/commands/stop", "stop somebody at the cell"}};
  for (const auto& one : k_cases) {
    token = one.token;
    local = one.local;
    const std::optional<control::Answer> answer = say(one.path);
    CHECK_TEXT(answer && answer->status == 200, one.name);
    CHECK_TEXT(memory_waits(), one.name);
    STRCMP_EQUAL(one.did, cell.did.back().c_str());
  }
  CHECK(say("/line/stop", "modbus")->status == 200);
  CHECK(memory_waits());
  STRCMP_EQUAL("stop the line's control", cell.did.back().c_str());
}

TEST(ApiStop, WhoMayNotIsToldSoWithoutADeed) {
  log_in("vic");
  lock_memory();
  CHECK(say("/commands/stop")->status == 403);
  token.clear();
  CHECK(say("/commands/stop")->status == 401);
  CHECK(memory_waits());
  // Whom only the memory may know is asked for where one may wait.
  token = "no session of this process";
  CHECK(!say("/commands/stop"));
  free_memory();
  LONGS_EQUAL(401, ask("POST", "/commands/stop").status);
  CHECK(say("/line/stop", "web")->status == 404);
  LONGS_EQUAL(0, cell.did.size());
}

TEST(ApiStop, SessionsOfAnEarlierServiceAreKnownAndEndedOnesAreNot) {
  log_in("ana");
  const accounts::Accounts later{*memory};
  CHECK(later.known(token) && later.known(token)->name == "ana");
  CHECK(accounts.known(token).has_value());
  CHECK(!later.known("").has_value() && !later.known("another").has_value());
  SUCCEEDS(accounts.change("ana", {.role = accounts::Role::Viewer}, "ada", "web"));
  CHECK(!accounts.known(token).has_value());
  log_in("ana");
  CHECK(accounts.known(token)->role == accounts::Role::Viewer);
  SUCCEEDS(accounts.log_out(token, "web"));
  CHECK(!accounts.known(token).has_value());
  log_in("eng");
  SUCCEEDS(accounts.remove("eng", "ada", "web"));
  CHECK(!accounts.known(token).has_value());
}

TEST(ApiStop, TheLogNamesWhoSaidItAlsoWhereTheMemoryWasBusy) {
  log_in("ana");
  local = true;
  lock_memory();
  CHECK(say("/commands/stop")->status == 200);
  CHECK(say("/commands/laser-off")->status == 200);
  // A control that holds its stop says it in each turn.
  for (int i = 0; i < 100; ++i) CHECK(say("/line/stop", "modbus")->status == 200);
  LONGS_EQUAL(102, cell.did.size());
  free_memory();
  const std::vector<memory::LogRow> rows = stops_in_log(3);
  LONGS_EQUAL(3, rows.size());
  STRCMP_EQUAL("the line's control", rows[0].who.c_str());
  STRCMP_EQUAL("modbus", rows[0].door.c_str());
  STRCMP_EQUAL("laser off", rows[1].action.c_str());
  STRCMP_EQUAL("ana", rows[2].who.c_str());
}

TEST(ApiStop, EachOrderSaysWhenItWasHeard) {
  log_in("ana");
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  put("scan-0001", "ok");
  heard = 41;
  const std::pair<const char*, Json> k_orders[] = {
      {"/commands/start", {}},       {"/commands/rescan", {{"why", "so"}}}, {"/scans/scan-0001/accept", {}},
      {"/scans/scan-0001/send", {}}, {"/scans/scan-0001/air", {}},          {"/scans/scan-0001/look", {}}};
  for (const auto& [path, body] : k_orders) {
    cell.stops = 99;
    CHECK_TEXT(ask("POST", path, body).status < 300, path);
    LONGS_EQUAL_TEXT(41, cell.stops, path);
  }
}

}  // namespace biteline::api
