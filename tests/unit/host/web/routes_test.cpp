// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/routes.hpp"

#include <CppUTest/TestHarness.h>

#include <set>

#include "host/interfaces/control/messages.hpp"

namespace biteline::web {

TEST_GROUP(Routes){};

TEST(Routes, EachHandlingIsOfSomeOperation) {
  std::set<Handling> asked_for;
  for (const Route& route : routes()) asked_for.insert(route.handling);
  LONGS_EQUAL(static_cast<int>(Handling::Metrics) + 1, asked_for.size());
}

TEST(Routes, SayWhoMayAsTheDocumentDoes) {
  const Route& accept = *find_route("POST", "/api/v1/scans/scan-0003/accept").route;
  STRCMP_EQUAL("accept_scan", std::string{accept.operation}.c_str());
  CHECK(accept.handling == Handling::Forward && accept.role == accounts::Role::Operator);
  CHECK(accept.control && !accept.local && accept.changes && !accept.is_long);
  CHECK(find_route("DELETE", "/api/v1/models/derby").route->is_long);
  CHECK(!find_route("POST", "/api/v1/processes/check").route->changes);
  CHECK(!find_route("POST", "/api/v1/sessions").route->role);
}

/// What the cell's own machine may without a session: a stop must not wait for a login there.
TEST(Routes, StopsAndTheFirstAccountAreLocal) {
  std::set<std::string_view> local;
  for (const Route& route : routes())
    if (route.local) local.insert(route.pattern);
  const std::set<std::string_view> expected{control::k_stop_path, control::k_laser_off_path, "/api/v1/users"};
  CHECK(expected == local);
}

TEST(Routes, NamesInThePathAreRead) {
  const RouteMatch match = find_route("GET", "/api/v1/scans/scan-0003/files/stages/6_sequence.png");
  CHECK(match.route != nullptr);
  CHECK(match.route->handling == Handling::File);
  LONGS_EQUAL(2, match.names.size());
  STRCMP_EQUAL("scan-0003", match.names[0].c_str());
  STRCMP_EQUAL("stages/6_sequence.png", match.names[1].c_str());
}

TEST(Routes, TheCloserPatternWins) {
  STRCMP_EQUAL("/api/v1/processes/schema",
               std::string{find_route("GET", "/api/v1/processes/schema").route->pattern}.c_str());
  CHECK(find_route("PUT", "/api/v1/processes/schema").route == nullptr);
}

TEST(Routes, AnotherMethodIsToldFromAnotherPath) {
  const RouteMatch match = find_route("PATCH", "/api/v1/sessions");
  CHECK(match.route == nullptr);
  LONGS_EQUAL(2, match.methods.size());
  for (const char* path : {"/", "/api/v1", "/api/v1/", "/api/v1/state/", "/api/v1/scans/a/b",
                           "/api/v1/scans//files", "/api/v1/states", "/api/v2/state", "/metrics/x"}) {
    CHECK_TEXT(find_route("GET", path).methods.empty(), path);
  }
}

TEST(Routes, ScansHaveTheServicesNames) {
  for (const char* name : {"scan-0001", "scan-123456789"}) CHECK_TEXT(is_scan_name(name), name);
  for (const char* name :
       {"", "scan-", "scan-001", "scan-0001x", "scan-1234567890", "..", "scan-00 1", "model"}) {
    CHECK_TEXT(!is_scan_name(name), name);
  }
}

}  // namespace biteline::web
