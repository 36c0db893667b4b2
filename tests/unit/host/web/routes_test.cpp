// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/routes.hpp"

#include <CppUTest/TestHarness.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <set>

namespace biteline::web {

TEST_GROUP(Routes){};

TEST(Routes, AreThoseOfTheDescription) {
  const YAML::Node description = YAML::LoadFile(BITELINE_OPENAPI);
  std::set<std::string> described;
  for (const auto& path : description["paths"]) {
    const auto name = path.first.as<std::string>();
    const std::string root = path.second["servers"] ? "" : "/api/v1";
    for (const auto& operation : path.second) {
      auto method = operation.first.as<std::string>();
      if (method == "parameters" || method == "servers") continue;
      std::ranges::transform(method, method.begin(),
                             [](unsigned char letter) { return std::toupper(letter); });
      described.insert(method + " " + root + name);
    }
  }
  std::set<std::string> served;
  for (const Route& route : routes()) {
    // Its clients speak Foxglove's own protocol there; no path of this API.
    if (route.handling == Handling::Foxglove) continue;
    served.insert(std::string{route.method} + " " + std::string{route.pattern});
  }
  for (const std::string& name : described)
    CHECK_TEXT(served.contains(name), ("not served: " + name).c_str());
  for (const std::string& name : served)
    CHECK_TEXT(described.contains(name), ("not described: " + name).c_str());
}

TEST(Routes, NamesInThePathAreRead) {
  const RouteMatch match = find_route("GET", "/api/v1/scans/scan-0003/files/stages/6_sequence.png");
  CHECK(match.route != nullptr);
  CHECK(match.route->handling == Handling::File);
  STRCMP_EQUAL("scan-0003", match.named.at("id").c_str());
  STRCMP_EQUAL("stages/6_sequence.png", match.named.at("path").c_str());
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
