// SPDX-License-Identifier: MIT
// A PolyScope X asked by its Robot API: the simulated one, and peers that answer otherwise.
#include "host/robot/link/ur/robot_api.hpp"

#include <CppUTest/TestHarness.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "hal/sim/robot/ur_controller.hpp"
#include "host/robot/link/ur/pendant_watch.hpp"
#include "host/robot/link/ur/told_version.hpp"

namespace biteline::robot::ur {
namespace {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

constexpr auto k_api_patience = 20s;  // of a loaded machine

HttpAnswer answer(int status, const std::string& body) {
  return {.status = status, .body = body};
}

/// Says `words` to each who has asked, and then closes or not.
class OddServer {
 public:
  OddServer(std::string words, bool closes) : words_{std::move(words)}, closes_{closes} {
    thread_ = std::thread{[this] { serve(); }};
  }
  ~OddServer() {
    stopping_ = true;
    thread_.join();
  }
  OddServer(const OddServer&) = delete;
  OddServer& operator=(const OddServer&) = delete;
  [[nodiscard]] Endpoint at() const { return {"127.0.0.1", listener_.port}; }
  [[nodiscard]] DoorPlaces places() const { return {.robot_api = at()}; }

 private:
  void serve() {
    std::vector<hal::Descriptor> clients;
    for (; !stopping_; std::this_thread::sleep_for(1ms)) {
      hal::Descriptor client = sim::accept_from(listener_);
      if (!client.is_open()) continue;
      std::vector<std::uint8_t> asked, said(words_.begin(), words_.end());
      while (!stopping_ && asked.empty() && sim::read_available(client, asked))
        std::this_thread::sleep_for(1ms);
      while (!stopping_ && !said.empty() && sim::write_available(client, said))
        std::this_thread::sleep_for(1ms);
      if (!closes_) clients.push_back(std::move(client));
    }
  }
  sim::TcpListener listener_{*sim::listen_on_loopback(0)};
  std::string words_;
  bool closes_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace

TEST_GROUP(RobotApi) {
  sim::ArmKinematics kinematics = *sim::ArmKinematics::named("ur5e");
  sim::Arm arm{kinematics,
               kinematics.T_base_flange((sim::JointVector() << 0, -1.8, 1.6, -1.4, -1.57, 0).finished())};
  std::unique_ptr<sim::UrController> controller;

  void be(const std::array<int, 3>& version) {
    controller.reset();
    controller = *sim::UrController::open({.version = version}, arm, {});
  }
  DoorPlaces places() const {
    const auto at = [](std::uint16_t port) { return Endpoint{"127.0.0.1", port}; };
    return {.dashboard = at(controller->ports().dashboard),
            .robot_api = at(controller->ports().robot_api),
            .script = at(controller->ports().primary)};
  }
  ControllerWords words() const {
    auto told = ask_controller(places(), k_api_patience);
    CHECK_TEXT(told.has_value(), told ? "" : to_line(told.error()).c_str());
    return *told;
  }
  std::unique_ptr<ControllerDoor> door() const {
    auto opened = ControllerDoor::open(places(), k_api_patience);
    CHECK_TEXT(opened.has_value(), opened ? "" : to_line(opened.error()).c_str());
    return std::move(*opened);
  }
  template <class Holds>
  static void comes(Holds holds) {
    const auto until = Steady::now() + k_api_patience;
    while (!holds() && Steady::now() < until) std::this_thread::sleep_for(1ms);
    CHECK(holds());
  }
};

TEST(RobotApi, OnlyAWordUnderItsKeyIsTaken) {
  STRCMP_EQUAL("RUNNING", text_in(answer(200, R"({"mode":"RUNNING","message":"ok"})"), "mode")->c_str());
  const struct {
    HttpAnswer answer;
    Errc code;
  } rows[] = {{answer(404, R"({"mode":"REMOTE"})"), Errc::NotSupported},
              {answer(401, R"({"mode":"REMOTE"})"), Errc::PeerRefused},
              {answer(403, R"({"mode":"REMOTE"})"), Errc::PeerRefused},
              {answer(307, ""), Errc::BadFormat},
              {answer(408, R"({"mode":"REMOTE"})"), Errc::BadFormat},
              {answer(500, R"({"mode":"REMOTE"})"), Errc::BadFormat},
              {answer(200, ""), Errc::BadFormat},
              {answer(200, "<html>REMOTE</html>"), Errc::BadFormat},
              {answer(200, R"({"mode":"REMOTE")"), Errc::BadFormat},
              {answer(200, R"(["mode","REMOTE"])"), Errc::BadFormat},
              {answer(200, R"({"mode":1})"), Errc::BadFormat},
              {answer(200, R"({"mode":null})"), Errc::BadFormat},
              {answer(200, R"({"Mode":"REMOTE"})"), Errc::BadFormat},
              {answer(200, R"({"mode":"RE\nMOTE"})"), Errc::BadFormat},
              {answer(200, R"({"mode":")" + std::string(61, 'A') + R"("})"), Errc::BadFormat}};
  for (const auto& row : rows) {
    const auto text = text_in(row.answer, "mode");
    CHECK_TEXT(!text.has_value(), row.answer.body.c_str());
    CHECK_TEXT(text.error().code == row.code, row.answer.body.c_str());
  }
}

TEST(RobotApi, AnOlderSoftwareTellsLessAndNothingOfItIsGuessed) {
  be({10, 14, 0});
  ControllerWords told = words();
  STRCMP_EQUAL("PolyScope X 10.14.0", told.version->c_str());
  STRCMP_EQUAL("UR5e", told.model->c_str());
  STRCMP_EQUAL("20235500001", told.serial->c_str());
  CHECK(told.remote == true);
  STRCMP_EQUAL("RUNNING", told.robot_mode->c_str());
  STRCMP_EQUAL("STOPPED", told.program_state->c_str());
  STRCMP_EQUAL("", told.odd.c_str());
  CHECK(!unsupported(told));

  be({10, 12, 1});
  told = words();
  CHECK(told.remote == true);
  STRCMP_EQUAL("RUNNING", told.robot_mode->c_str());
  CHECK(!told.model);
  CHECK(!told.serial);
  STRCMP_CONTAINS("not known: /system/v1/information: this software does not tell (HTTP 404)",
                  summary(told).c_str());
  CHECK(!unsupported(told));

  be({10, 11, 0});
  told = words();
  STRCMP_EQUAL("PolyScope X 10.11.0", told.version->c_str());
  STRCMP_EQUAL("STOPPED", told.program_state->c_str());
  CHECK(!told.remote);
  CHECK(!told.robot_mode);
  STRCMP_EQUAL("PolyScope 10.11.0 is too old: 10.12.0 is the least", unsupported(told)->c_str());
}

TEST(RobotApi, TellsLocalControlPowerAndTheProgram) {
  be({10, 14, 0});
  controller->set_remote_control(false);
  controller->set_powered(false);
  ControllerWords told = words();
  CHECK(told.remote == false);
  STRCMP_EQUAL("POWER_OFF", told.robot_mode->c_str());
  controller->set_remote_control(true);
  controller->set_powered(true);
  arm.run(*sim::parse_script("def long():\n  sleep(100)\nend\n"), hal::monotonic_now());
  told = words();
  CHECK(told.remote == true);
  STRCMP_EQUAL("PLAYING", told.program_state->c_str());
}

/// In local control its primary interface may be closed: that the arm is not in remote control is known.
TEST(RobotApi, AVersionThatNobodyTellsHidesNothingElse) {
  be({10, 14, 0});
  DoorPlaces no_primary = places();
  no_primary.script.port = 1;
  const auto told = ask_controller(no_primary, k_api_patience);
  CHECK(told.has_value());
  CHECK(!told->version);
  CHECK(told->remote == true);
  STRCMP_CONTAINS("not known: the version of its software: 127.0.0.1:1", summary(*told).c_str());
}

TEST(RobotApi, AStopEndsTheProgramAndInLocalControlNothing) {
  be({10, 14, 0});
  const auto sut = door();
  const auto runs = [&] { return arm.at(hal::monotonic_now()).program_running; };
  const auto say_stop = [&] {
    arm.run(*sim::parse_script("def long():\n  sleep(100)\nend\n"), hal::monotonic_now());
    Delivery words[]{sut->stop_word()};
    CHECK(deliver(words, k_api_patience).has_value());
  };
  say_stop();
  comes([&] { return !runs(); });
  say_stop();  // over a connection of its own, again
  comes([&] { return !runs(); });
  controller->set_remote_control(false);
  say_stop();
  std::this_thread::sleep_for(200ms);
  CHECK(runs());
}

TEST(RobotApi, ItsQuestionWaitsForNobody) {
  OddServer silent{"", false};
  DoorPlaces there = silent.places();
  RobotApi sut{there};
  const auto begin = Steady::now();
  CHECK(sut.ask_remote().has_value());
  CHECK(sut.hear_remote(0ns).error().code == Errc::Timeout);
  CHECK(Steady::now() - begin < 1s);
  // After two seconds it is given up, and may be asked anew.
  Errc last = Errc::Timeout;
  comes([&] { return last != Errc::Timeout || (last = sut.hear_remote(0ns).error().code) != Errc::Timeout; });
  CHECK(last == Errc::ConnectionLost);
  CHECK(sut.ask_remote().has_value());
  CHECK(sut.hear_remote(0ns).error().code == Errc::Timeout);
}

TEST(RobotApi, OddPeersAreNamedInTimeAndNoneIsGood) {
  const std::string head = "HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n";
  const struct {
    const char* name;
    std::string words;
    bool closes;
    Errc code;
  } rows[] = {
      {"slow", "", false, Errc::Timeout},
      {"cut at once", "", true, Errc::ConnectionLost},
      {"cut in the head", "HTTP/1.1 200 O", true, Errc::ConnectionLost},
      {"cut in the body", head + "Content-Length: 40\r\n\r\n{\"state\":", true, Errc::ConnectionLost},
      {"stuck in the body", head + "Content-Length: 40\r\n\r\n{\"state\":", false, Errc::Timeout},
      {"huge by its own word", head + "Content-Length: 4000000000\r\n\r\n{", false, Errc::ProtocolError},
      {"huge body", head + "\r\n" + std::string(200'000, ' '), false, Errc::ProtocolError},
      {"huge head", "HTTP/1.1 200 OK\r\nX: " + std::string(20'000, 'x'), false, Errc::ProtocolError},
      {"another protocol", "Connected: Universal Robots Dashboard Server\n", false, Errc::ProtocolError},
      {"no JSON", head + "Content-Length: 5\r\n\r\nhello", false, Errc::BadFormat},
      {"404", "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n", false, Errc::NotSupported},
      {"401", "HTTP/1.1 401 Unauthorized\r\nContent-Length: 0\r\n\r\n", false, Errc::PeerRefused},
      {"redirect", "HTTP/1.1 307 Elsewhere\r\nLocation: https://there/\r\nContent-Length: 0\r\n\r\n", false,
       Errc::BadFormat},
      {"5xx", "HTTP/1.1 503 Unavailable\r\n\r\n", true, Errc::BadFormat}};
  for (const auto& row : rows) {
    const OddServer odd{row.words, row.closes};
    const auto begin = Steady::now();
    const auto opened =
        RobotApi::open(odd.places(), row.code == Errc::Timeout ? Nanoseconds{300ms} : k_api_patience);
    CHECK_TEXT(!opened.has_value(), row.name);
    CHECK_TEXT(opened.error().code == row.code, (row.name + (": " + to_line(opened.error()))).c_str());
    CHECK_TEXT(Steady::now() - begin < 10s, row.name);
    CHECK_TEXT(to_line(opened.error()).find('\n') == std::string::npos, row.name);
  }
  // Without a length to the end of the connection, or in pieces, it is an answer all the same.
  const OddServer until_end{head + "\r\n{\"state\":\"STOPPED\"}", true};
  CHECK(RobotApi::open(until_end.places(), k_api_patience).has_value());
  const OddServer chunked{
      head + "Transfer-Encoding: chunked\r\n\r\n9\r\n{\"state\":\r\na\r\n\"STOPPED\"}\r\n0\r\n\r\n", false};
  CHECK(RobotApi::open(chunked.places(), k_api_patience).has_value());
}

TEST(RobotApi, TheDoorIsTheOneThatTheControllerHas) {
  be({3, 15, 8});
  STRCMP_CONTAINS("URSoftware 3.15.8", words().version->c_str());
  CHECK(!words().remote);
  be({5, 12, 0});
  DoorPlaces both = places();
  both.robot_api = {"127.0.0.1", 1};
  STRCMP_CONTAINS("URSoftware 5.12.0", ask_controller(both, k_api_patience)->version->c_str());
  be({10, 14, 0});
  both = places();
  both.dashboard = {"127.0.0.1", 1};
  STRCMP_EQUAL("PolyScope X 10.14.0", ask_controller(both, k_api_patience)->version->c_str());
  both.robot_api = both.dashboard;
  const auto none = ask_controller(both, k_api_patience);
  CHECK(!none.has_value());
  for (const char* part : {"127.0.0.1:1: no dashboard server there", "Robot API: 127.0.0.1:1"})
    STRCMP_CONTAINS(part, to_line(none.error()).c_str());
}

TEST(RobotApi, WhoTakesTheArmAtThePendantIsTold) {
  be({10, 14, 0});
  std::atomic<int> taken{0};
  const PendantWatch watch{{.doors = places(), .period = 5ms, .patience = 2s, .retry = 20ms},
                           [&] { ++taken; }};
  std::this_thread::sleep_for(1s);
  LONGS_EQUAL(0, taken);
  controller->set_remote_control(false);
  comes([&] { return taken == 1; });
  controller->set_remote_control(true);
  std::this_thread::sleep_for(1s);
  controller->set_remote_control(false);
  comes([&] { return taken == 2; });
}

TEST(RobotApi, VersionIsTheFirstMessageOfThePrimaryInterface) {
  be({10, 12, 1});
  const auto told = ask_version(places().script, k_api_patience);
  CHECK(told.has_value());
  CHECK(*told == SoftwareVersion({10, 12, 1}));
  // Length, message, stamp, source, version; of the rest the project's name alone.
  std::vector<std::uint8_t> bytes{0, 0, 0, 18, 20, 0, 0, 0, 0, 0, 0, 0, 0, 0xfe, 3, 2, 'U', 'R'};
  for (std::size_t size = 0; size < bytes.size(); ++size)
    CHECK(!version_in(std::span{bytes}.first(size))->has_value());
  CHECK(version_in(bytes).error().code == Errc::BadFormat);
}

}  // namespace biteline::robot::ur
