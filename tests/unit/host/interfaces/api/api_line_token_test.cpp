// SPDX-License-Identifier: MIT
// Which program is a door of the line's control: the one that shows the service's token.
#include <CppUTest/TestHarness.h>

#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

TEST_GROUP_BASE(ApiLineToken, ApiWorld){};

TEST(ApiLineToken, AProgramThatCallsItselfADoorChoosesAndStartsNothing) {
  Api guarded{Rooms{.memory = *memory,
                    .accounts = accounts,
                    .cell = cell,
                    .results = folder.path(),
                    .processes = ProcessStore{BITELINE_PROCESSES, folder.path() / "processes"},
                    .models = transfer::Library{folder.path() / "models"},
                    .exchange = Exchange{folder.path() / ".exchange"},
                    .version = "1.2.3",
                    .publish = {},
                    .last_seq = {},
                    .catalogue = [this] { return catalogue; },
                    .line_token = "the service's token"}};
  control::Request request;
  request.local = true;
  const auto status = [&](const char* door, const std::string& shown, const char* method, const char* path,
                          const Json& body) {
    request.door = door;
    request.token = shown;
    request.method = method;
    request.path = std::string{"/api/v1"} + path;
    request.body = body;
    return guarded.ordinary(request).status;
  };
  for (const char* door : {"modbus", "text"}) {
    for (const char* wrong : {"", "another", "the service's toke", "the service's token "}) {
      LONGS_EQUAL(403, status(door, wrong, "PUT", "/line/job", {{"job", 1}}));
      LONGS_EQUAL(403, status(door, wrong, "POST", "/line/start", {{"request", 7}}));
      // To read is harmless, and the heartbeat hangs on it.
      LONGS_EQUAL(200, status(door, wrong, "GET", "/line", {}));
    }
    CHECK(cell.did.empty());
  }
  LONGS_EQUAL(404, status("web", "the service's token", "POST", "/line/start", {{"request", 7}}));
  LONGS_EQUAL(200, status("text", "the service's token", "POST", "/line/start", {{"request", 7}}));
  STRCMP_EQUAL("line start 7", cell.did.back().c_str());
}

}  // namespace biteline::api
