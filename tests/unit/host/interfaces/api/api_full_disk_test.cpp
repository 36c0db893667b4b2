// SPDX-License-Identifier: MIT
// What a full disk does to requests: nobody is kept out, and what was not kept is said as 507.
#include <CppUTest/TestHarness.h>

#include "tests/support/full_disk.hpp"
#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

struct ApiFullDiskWorld : ApiWorld {
  static const char* message_of(const control::Answer& answer) {
    return answer.body["error"]["message"].get_ref<const std::string&>().c_str();
  }
  void refuses(const std::string& method, const std::string& path, const Json& body = {}) {
    const control::Answer answer = ask(method, path, body);
    const std::string asked = method + " " + path + " " + test::text_of(answer.body);
    LONGS_EQUAL_TEXT(507, answer.status, asked.c_str());
    STRCMP_EQUAL_TEXT("disk_full", code_of(answer).c_str(), asked.c_str());
  }
};

TEST_GROUP_BASE(ApiFullDisk, ApiFullDiskWorld){};

TEST(ApiFullDisk, WhoComesGetsInAndIsToldWhatARestartWouldDo) {
  log_in("ada");
  const test::FullDisk full;
  const control::Answer left = ask("DELETE", "/sessions");
  LONGS_EQUAL(507, left.status);
  STRCMP_CONTAINS("you are logged out until the service restarts", message_of(left));
  LONGS_EQUAL(401, ask("GET", "/me").status);
  const control::Answer login = ask("POST", "/sessions", {{"name", "ada"}, {"password", k_password}});
  LONGS_EQUAL(201, login.status);
  STRCMP_CONTAINS("a restart of the service ends it",
                  login.body["not_kept"].get_ref<const std::string&>().c_str());
  token = login.body["token"].get<std::string>();
  LONGS_EQUAL(200, ask("GET", "/me").status);
  LONGS_EQUAL(401, ask("POST", "/sessions", {{"name", "ada"}, {"password", "a wrong one"}}).status);
  LONGS_EQUAL(204, ask("DELETE", "/sessions").status);
}

TEST(ApiFullDisk, WhatCannotBeKeptIsRefusedAsSuch) {
  put("scan-0001", "ok");
  write_sample("scan-0001");
  log_in("ada");
  LONGS_EQUAL(201,
              ask("POST", "/models", {{"name", "old"}, {"scan", "scan-0001"}, {"process", "grind"}}).status);
  const Json grind = ask("GET", "/processes/grind").body["process"];
  {
    const test::FullDisk full;
    refuses("POST", "/control", {{"action", "take"}});
    refuses("POST", "/users", {{"name", "bob"}, {"role", "viewer"}, {"password", k_password}});
    refuses("PATCH", "/users/ana", {{"role", "engineer"}});
    refuses("DELETE", "/users/ana");
    refuses("POST", "/scans/scan-0001/keep", {{"kept", true}});
    refuses("POST", "/models", {{"name", "new"}, {"scan", "scan-0001"}, {"process", "grind"}});
    refuses("PUT", "/processes/mine", grind);
    LONGS_EQUAL(404, ask("GET", "/models/new").status);
    LONGS_EQUAL(404, ask("GET", "/processes/mine").status);
    // What makes room is done, and the answer says so.
    const control::Answer removed = ask("DELETE", "/models/old");
    LONGS_EQUAL(507, removed.status);
    STRCMP_CONTAINS("model old is removed; that could not be noted", message_of(removed));
    LONGS_EQUAL(404, ask("GET", "/models/old").status);
  }
  // Room again: all goes on without a restart.
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  LONGS_EQUAL(200, ask("POST", "/scans/scan-0001/keep", {{"kept", true}}).status);
}

}  // namespace biteline::api
