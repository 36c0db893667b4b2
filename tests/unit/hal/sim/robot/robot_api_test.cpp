// SPDX-License-Identifier: MIT
#include "hal/sim/robot/robot_api.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::sim::robot_api {

TEST_GROUP(SimRobotApi) {
  State state{.model = "UR5e", .serial = "20235500001"};
  std::map<std::string, std::string> scripts{{"wait", "sleep(10)\n"}};
  Memory memory;

  Answer ask(const char* method, const std::string& path, const std::string& body) {
    return answer_to({.method = method, .target = "/universal-robots/robot-api" + path, .body = body}, state,
                     scripts, memory);
  }
  Answer get(const std::string& path) {
    return ask("GET", path, {});
  }
  Answer put(const std::string& path, const std::string& action) {
    return ask("PUT", path, R"({"action": ")" + action + R"("})");
  }
};

TEST(SimRobotApi, ARequestIsTakenOnceItIsWhole) {
  const std::string text =
      "PUT /a HTTP/1.1\r\nHost: b\r\nContent-Length: 4\r\n\r\nbody"
      "GET /c HTTP/1.1\r\n\r\n";
  std::vector<std::uint8_t> bytes;
  std::vector<Request> taken;
  for (const char letter : text) {
    bytes.push_back(static_cast<std::uint8_t>(letter));
    if (auto request = take_request(bytes)) taken.push_back(*request);
  }
  LONGS_EQUAL(2, taken.size());
  STRCMP_EQUAL("PUT /a body", (taken[0].method + " " + taken[0].target + " " + taken[0].body).c_str());
  STRCMP_EQUAL("GET /c ", (taken[1].method + " " + taken[1].target + " " + taken[1].body).c_str());
  CHECK(bytes.empty());
}

TEST(SimRobotApi, EachSoftwareHasWhatItIsKnownToHave) {
  const struct {
    const char *path, *body;
    int from_minor;
  } rows[] = {{"/program/v1/state", R"({"state":"STOPPED"})", 11},
              {"/program/v1/loaded", R"({"name":"Default program"})", 12},
              {"/system/v1/controlmode", R"({"mode":"REMOTE"})", 12},
              {"/system/v1/operationalmode", R"({"mode":"AUTOMATIC"})", 12},
              {"/robotstate/v1/robotmode", R"({"mode":"RUNNING"})", 12},
              {"/robotstate/v1/safetymode", R"({"mode":"NORMAL"})", 12},
              {"/system/v1/information", R"({"robotType":"UR5e","serialNumber":"20235500001"})", 14},
              {"/versions/v1", R"({"marketingVersion":"10.14.0"})", 14},
              {"/no/such", "", 99}};
  for (const auto& row : rows) {
    for (const int minor : {11, 12, 13, 14}) {
      state.version = {10, minor, 0};
      const Answer answer = get(row.path);
      LONGS_EQUAL(minor >= row.from_minor ? 200 : 404, answer.status);
      if (answer.status == 200) STRCMP_EQUAL(row.body, answer.body.c_str());
    }
  }
}

TEST(SimRobotApi, OrdersAreTakenInRemoteControlAlone) {
  CHECK(put("/program/v1/state", "stop").order == Order::Stop);
  CHECK(put("/robotstate/v1/state", "POWER_OFF").order == Order::PowerOff);
  CHECK(put("/robotstate/v1/state", "BRAKE_RELEASE").order == Order::ReleaseBrakes);
  LONGS_EQUAL(409, put("/robotstate/v1/state", "UNLOCK_PROTECTIVE_STOP").status);
  state.protective_stop = true;
  CHECK(put("/robotstate/v1/state", "UNLOCK_PROTECTIVE_STOP").order == Order::Unlock);
  LONGS_EQUAL(422, put("/robotstate/v1/state", "DANCE").status);
  state.remote = false;
  LONGS_EQUAL(403, put("/program/v1/state", "stop").status);
  CHECK(put("/program/v1/state", "stop").order == Order::None);
  LONGS_EQUAL(200, get("/program/v1/state").status);
}

TEST(SimRobotApi, AProgramIsLoadedAndPlayedWhereTheArmRuns) {
  LONGS_EQUAL(409, put("/program/v1/state", "play").status);  // the default program is nothing
  LONGS_EQUAL(404, ask("PUT", "/program/v1/loaded", R"({"name":"none"})").status);
  CHECK(ask("PUT", "/program/v1/loaded", R"({"name":"wait"})").order == Order::Load);
  STRCMP_EQUAL(R"({"name":"wait"})", get("/program/v1/loaded").body.c_str());
  CHECK(put("/program/v1/state", "play").order == Order::Play);
  CHECK(put("/program/v1/state", "pause").order == Order::Pause);
  CHECK(put("/program/v1/state", "resume").order == Order::Play);
  state.mode = RobotMode::Idle;
  LONGS_EQUAL(409, put("/program/v1/state", "play").status);
}

TEST(SimRobotApi, ProgramsAreKeptAndGivenBackAsTheyCame) {
  const std::string program = R"({"program": {"programInformation": {"name": "new one"}}})";
  const auto form = [&](const std::string& text) {
    return "--b\r\nContent-Disposition: form-data; name=\"file\"\r\n\r\n" + text + "\r\n--b--\r\n";
  };
  LONGS_EQUAL(404, ask("PUT", "/programs/v1/", form(program)).status);
  LONGS_EQUAL(422, ask("POST", "/programs/v1/", form("{}")).status);
  LONGS_EQUAL(422, ask("POST", "/programs/v1/", "no form").status);
  STRCMP_EQUAL(R"({"programName":"new one"})", ask("POST", "/programs/v1/", form(program)).body.c_str());
  LONGS_EQUAL(400, ask("POST", "/programs/v1/", form(program)).status);
  LONGS_EQUAL(200, ask("PUT", "/programs/v1/", form(program)).status);
  STRCMP_EQUAL(program.c_str(), get("/programs/v1/new%20one").body.c_str());
  LONGS_EQUAL(404, get("/programs/v1/other").status);
  STRCMP_CONTAINS(R"("name":"new one")", get("/programs/v1/").body.c_str());
  STRCMP_CONTAINS(R"("name":"wait")", get("/programs/v1/").body.c_str());
}

}  // namespace biteline::sim::robot_api
