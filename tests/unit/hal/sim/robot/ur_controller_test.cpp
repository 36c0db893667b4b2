// SPDX-License-Identifier: MIT
#include "hal/sim/robot/ur_controller.hpp"

#include <CppUTest/TestHarness.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <utility>

#include "common/rtde/client_session.hpp"

namespace biteline::sim {

namespace {

/// Generous: a busy machine must not fail the test, and a right answer comes in milliseconds.
constexpr int k_patience_ms = 10'000;

hal::Descriptor connect_to(std::uint16_t port) {
  hal::Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  CHECK(connect(socket.number(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  return socket;
}

void send_text(const hal::Descriptor& socket, const std::string& text) {
  LONGS_EQUAL(text.size(), send(socket.number(), text.data(), text.size(), MSG_NOSIGNAL));
}

std::string read_line(const hal::Descriptor& socket) {
  std::string line;
  for (;;) {
    pollfd wait{socket.number(), POLLIN, 0};
    char letter = 0;
    if (poll(&wait, 1, k_patience_ms) <= 0 || recv(socket.number(), &letter, 1, 0) != 1)
      return line + " <closed>";
    if (letter == '\n') return line;
    line += letter;
  }
}

/// Words among the states that come there, too.
bool says(const hal::Descriptor& socket, std::string_view words) {
  std::string heard;
  while (heard.find(words) == std::string::npos) {
    pollfd wait{socket.number(), POLLIN, 0};
    char bytes[500];
    if (poll(&wait, 1, k_patience_ms) <= 0) return false;
    const auto size = recv(socket.number(), bytes, sizeof bytes, 0);
    if (size <= 0) return false;
    heard.append(bytes, static_cast<std::size_t>(size));
  }
  return true;
}

class Recorder final : public rtde::ClientListener {
 public:
  void on_data(std::size_t, std::span<const rtde::Value> values) override {
    stamps_s.push_back(std::get<double>(values[0]));
    poses.push_back(std::get<rtde::Vector6>(values[1]));
    states.push_back(std::get<std::uint32_t>(values[2]));
  }
  void on_text(const rtde::TextMessage&) override {}
  std::vector<double> stamps_s;
  std::vector<rtde::Vector6> poses;
  std::vector<std::uint32_t> states;
};

/// An RTDE client that reads until `enough` says so.
class Client {
 public:
  explicit Client(std::uint16_t port)
      : socket_(connect_to(port)),
        session_({.outputs = {{.variables = {{"timestamp", rtde::FieldType::Double},
                                             {"actual_TCP_pose", rtde::FieldType::Vector6d},
                                             {"runtime_state", rtde::FieldType::Uint32}},
                               .frequency_hz = 500}},
                  .inputs = {}}) {
    session_.start();
  }
  template <class Enough>
  bool read_until(Enough enough) {
    const auto until = hal::monotonic_now() + Nanoseconds{k_patience_ms * 1'000'000LL};
    while (hal::monotonic_now() < until) {
      CHECK(write_available(socket_, session_.outgoing()));
      pollfd wait{socket_.number(), POLLIN, 0};
      poll(&wait, 1, 100);
      std::vector<std::uint8_t> bytes;
      CHECK(read_available(socket_, bytes));
      CHECK(session_.consume(bytes, recorder).has_value());
      if (enough(recorder)) return true;
    }
    return false;
  }
  Recorder recorder;

 private:
  hal::Descriptor socket_;
  rtde::ClientSession session_;
};

}  // namespace

TEST_GROUP(UrController) {
  ArmKinematics kinematics = *ArmKinematics::named("ur5e");
  SE3 T_start = kinematics.T_base_flange((JointVector() << 0.1, -1.4, 1.7, -1.8, -1.5, 0.2).finished());
  Arm arm{kinematics, T_start};
  std::unique_ptr<UrController> sut = *UrController::open({}, arm, {});
};

TEST(UrController, StreamsPosesAtTheCyclesOfItsOwnClock) {
  Client client(sut->ports().rtde);
  CHECK(client.read_until([](const Recorder& r) { return r.poses.size() >= 20; }));
  const auto& r = client.recorder;
  DOUBLES_EQUAL(T_start.translation().x() / 1000, r.poses[0][0], 1e-9);
  for (std::size_t i = 1; i < r.stamps_s.size(); ++i) {
    const double cycles = (r.stamps_s[i] - r.stamps_s[i - 1]) * 500;
    DOUBLES_EQUAL(std::round(cycles), cycles, 1e-4);  // late cycles are skipped, never shifted
    CHECK(cycles > 0.5);
  }
}

TEST(UrController, RunsAScriptToItsEnd) {
  Client client(sut->ports().rtde);
  const hal::Descriptor script = connect_to(sut->ports().script);
  const double x_m = T_start.translation().x() / 1000, y_m = T_start.translation().y() / 1000,
               z_m = T_start.translation().z() / 1000;
  const Vec3 r = geometry::log_so3(T_start.linear());
  char text[300];
  std::snprintf(text, sizeof text, "def go():\n  movel(p[%.6f,%.6f,%.6f,%.6f,%.6f,%.6f], a=2, v=0.2)\nend\n",
                x_m, y_m, z_m + 0.02, r.x(), r.y(), r.z());
  send_text(script, text);
  CHECK(client.read_until([&](const Recorder& rec) {
    return !rec.poses.empty() && std::abs(rec.poses.back()[2] - z_m - 0.02) < 1e-6 && rec.states.back() == 1;
  }));
  CHECK(std::find(client.recorder.states.begin(), client.recorder.states.end(), 2U) !=
        client.recorder.states.end());
  LONGS_EQUAL(1, sut->scripts_run());
}

TEST(UrController, BlendsThatMeetAreToldToThePrimaryPort) {
  const hal::Descriptor script = connect_to(sut->ports().primary);
  send_text(script,
            "def close():\n  movep(p[0.4,0,0.3,0,3.1,0], r=0.0008)\n"
            "  movep(p[0.4015,0,0.3,0,3.1,0], r=0.0008)\nend\n");
  CHECK(says(script, "Overlapping Blends in a move command: move 2 skipped"));
  LONGS_EQUAL(1, sut->moves_skipped());
  LONGS_EQUAL(1, sut->scripts_run());
}

/// Whoever sent it: a real secondary port says nothing of it.
TEST(UrController, AScriptItCannotReadMovesNothingAndThePrimaryPortSaysSo) {
  const hal::Descriptor primary = connect_to(sut->ports().primary), script = connect_to(sut->ports().script);
  CHECK(says(primary, "URControl"));
  CHECK(says(script, "URControl"));
  send_text(script, "def bad():\n  servoj([0,0,0,0,0,0])\nend\n");
  CHECK(says(primary, "servoj"));
  std::vector<std::uint8_t> heard;
  CHECK(read_available(script, heard));
  CHECK(std::string(heard.begin(), heard.end()).find("servoj") == std::string::npos);
  LONGS_EQUAL(1, sut->scripts_refused());
  CHECK_FALSE(arm.at(hal::monotonic_now()).moving);
}

TEST(UrController, TheDashboardAnswersAndStops) {
  const hal::Descriptor dashboard = connect_to(sut->ports().dashboard);
  STRCMP_EQUAL("Connected: Universal Robots Dashboard Server", read_line(dashboard).c_str());
  send_text(dashboard, "robotmode\n");
  STRCMP_EQUAL("Robotmode: RUNNING", read_line(dashboard).c_str());
  arm.run(*parse_script("sleep(100)\n"), hal::monotonic_now());
  send_text(dashboard, "running\n");
  STRCMP_EQUAL("Program running: true", read_line(dashboard).c_str());
  send_text(dashboard, "stop\nrunning\n");
  STRCMP_EQUAL("Stopped", read_line(dashboard).c_str());
  STRCMP_EQUAL("Program running: false", read_line(dashboard).c_str());
  send_text(dashboard, "dance\n");
  STRCMP_CONTAINS("could not understand", read_line(dashboard).c_str());
  send_text(dashboard, "quit\n");
  STRCMP_EQUAL("Disconnected", read_line(dashboard).c_str());
  STRCMP_EQUAL(" <closed>", read_line(dashboard).c_str());
}

TEST(UrController, DashboardTellsWhatAGateAsks) {
  const hal::Descriptor dashboard = connect_to(sut->ports().dashboard);
  read_line(dashboard);
  const auto ask = [&](const char* words) {
    send_text(dashboard, std::string{words} + "\n");
    return read_line(dashboard);
  };
  STRCMP_EQUAL("true", ask("is in remote control").c_str());
  STRCMP_EQUAL("UR5e", ask("get robot model").c_str());
  STRCMP_EQUAL("20235500001", ask("get serial number").c_str());
  STRCMP_EQUAL("Safetystatus: NORMAL", ask("safetystatus").c_str());
  STRCMP_EQUAL("URSoftware 5.12.0.0 (simulated by Biteline)", ask("PolyscopeVersion").c_str());
  sut->set_remote_control(false);
  STRCMP_EQUAL("false", ask("is in remote control").c_str());
}

TEST(UrController, NoProgramRunsInLocalModeOrInAProtectiveStop) {
  const hal::Descriptor script = connect_to(sut->ports().script);
  const auto refused = [&](std::uint64_t count) {
    send_text(script, "def wait():\n  sleep(100)\nend\n");
    for (int i = 0; i < k_patience_ms && sut->scripts_refused() < count; ++i) poll(nullptr, 0, 1);
    return sut->scripts_refused();
  };
  sut->set_remote_control(false);
  LONGS_EQUAL(1, refused(1));
  sut->set_remote_control(true);
  sut->set_protective_stop(true);
  LONGS_EQUAL(2, refused(2));
  CHECK_FALSE(arm.at(hal::monotonic_now()).program_running);
  const hal::Descriptor dashboard = connect_to(sut->ports().dashboard);
  read_line(dashboard);
  send_text(dashboard, "safetymode\nunlock protective stop\nsafetymode\n");
  STRCMP_EQUAL("Safetymode: PROTECTIVE_STOP", read_line(dashboard).c_str());
  STRCMP_CONTAINS("Cannot unlock protective stop until 5s", read_line(dashboard).c_str());
  STRCMP_EQUAL("Safetymode: PROTECTIVE_STOP", read_line(dashboard).c_str());
}

TEST(UrController, ThePrimaryPortTellsAProgramsBeginAndEnd) {
  const hal::Descriptor primary = connect_to(sut->ports().primary);
  send_text(primary, "def short_one():\n  sleep(0.02)\nend\n");
  CHECK(says(primary, "PROGRAM_XXX_STARTEDshort_one"));
  CHECK(says(primary, "PROGRAM_XXX_STOPPED"));
}

/// Clients of the primary port wait for a state before they send anything.
TEST(UrController, ThePrimaryPortSendsStates) {
  const hal::Descriptor primary = connect_to(sut->ports().primary);
  std::vector<std::uint8_t> bytes;
  // First, once: the version, then the arm's kinematics and configuration.
  constexpr std::size_t k_version = 56, k_kinematics = 230, k_configuration = 450,
                        k_first = k_version + k_kinematics + k_configuration;
  for (int i = 0; i < k_patience_ms && bytes.size() < k_first + 104; ++i) {
    pollfd wait{primary.number(), POLLIN, 0};
    poll(&wait, 1, 1);
    CHECK(read_available(primary, bytes));
  }
  CHECK(bytes.size() >= k_first + 104);
  const std::vector<std::uint8_t> version{0, 0, 0, 56, 20}, rows{0, 0, 0, 230, 16, 0, 0, 0, 225, 5},
      limits{0, 0, 1, 194, 16, 0, 0, 1, 189, 6};
  CHECK(std::equal(version.begin(), version.end(), bytes.begin()));
  CHECK(std::equal(rows.begin(), rows.end(), bytes.begin() + k_version));
  CHECK(std::equal(limits.begin(), limits.end(), bytes.begin() + k_version + k_kinematics));
  bytes.erase(bytes.begin(), bytes.begin() + k_first);
  for (const std::size_t at : {std::size_t{0}, std::size_t{52}}) {
    const std::vector<std::uint8_t> head(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                         bytes.begin() + static_cast<std::ptrdiff_t>(at + 10));
    const std::vector<std::uint8_t> expected{0, 0, 0, 52, 16, 0, 0, 0, 47, 0};
    CHECK(expected == head);
  }
  // Behind the stamp, as "Client interfaces" lays out the robot mode data of 5.4 and later: connected,
  // enabled, powered, no emergency stop, no protective stop, no program, not paused; RUNNING, POSITION; the
  // slider's, the scaling's and the limit's 1.0; one byte kept free.
  const std::vector<std::uint8_t> mode{1, 1, 1, 0, 0, 0, 0, 7, 0};
  const std::vector<std::uint8_t> one{0x3f, 0xf0, 0, 0, 0, 0, 0, 0};
  const auto part = [&](std::ptrdiff_t from, std::ptrdiff_t size) {
    return std::vector<std::uint8_t>(bytes.begin() + from, bytes.begin() + from + size);
  };
  CHECK(mode == part(18, 9));
  for (const std::ptrdiff_t at : {27, 35, 43}) CHECK(one == part(at, 8));
  LONGS_EQUAL(0, bytes[51]);
}

/// A host that keeps its script connection and never reads loses states, and nothing else.
TEST(UrController, TheScriptPortSendsStatesAlsoToWhoNeverReads) {
  const hal::Descriptor deaf = connect_to(sut->ports().script), reader = connect_to(sut->ports().script);
  const int small = 1;
  setsockopt(deaf.number(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < k_patience_ms && bytes.size() < 156; ++i) {
    pollfd wait{reader.number(), POLLIN, 0};
    poll(&wait, 1, 1);
    CHECK(read_available(reader, bytes));
  }
  CHECK(bytes.size() >= 156);
  send_text(deaf, "def wait():\n  sleep(100)\nend\n");
  for (int i = 0; i < k_patience_ms && sut->scripts_run() < 1; ++i) poll(nullptr, 0, 1);
  LONGS_EQUAL(1, sut->scripts_run());
}

TEST(UrController, ScriptConnectionsAreClosedOnDemandAndTakenAnew) {
  const hal::Descriptor first = connect_to(sut->ports().script);
  send_text(first, "def wait():\n  sleep(100)\nend\n");
  for (int i = 0; i < k_patience_ms && sut->scripts_run() < 1; ++i) poll(nullptr, 0, 1);
  sut->close_script_connections();
  CHECK_FALSE(says(first, "words that never come"));  // the end of the connection
  CHECK(arm.at(hal::monotonic_now()).program_running);
  const hal::Descriptor second = connect_to(sut->ports().script);
  send_text(second, "def other():\n  sleep(100)\nend\n");
  for (int i = 0; i < k_patience_ms && sut->scripts_run() < 2; ++i) poll(nullptr, 0, 1);
  LONGS_EQUAL(2, sut->scripts_run());
}

/// Lines as they stand in Universal Robots' "Dashboard Server e-Series" and in its client library's tests.
TEST(UrController, DashboardsLinesAreThoseOfTheManual) {
  const hal::Descriptor dashboard = connect_to(sut->ports().dashboard);
  STRCMP_CONTAINS("Connected: Universal Robots Dashboard Server", read_line(dashboard).c_str());
  const struct {
    const char *asked, *answered;
  } rows[] = {{"robotmode\n", "Robotmode: RUNNING"},
              {"robotmode\r\n", "Robotmode: RUNNING"},
              {"safetymode\n", "Safetymode: NORMAL"},
              {"safetystatus\n", "Safetystatus: NORMAL"},
              {"running\n", "Program running: false"},
              {"programState\n", "STOPPED <unnamed>"},
              {"is in remote control\n", "true"},
              {"stop\n", "Stopped"},
              {"no such command\n", "could not understand: 'no such command'"},
              {"quit\n", "Disconnected"}};
  for (const auto& row : rows) {
    send_text(dashboard, row.asked);
    STRCMP_EQUAL(row.answered, read_line(dashboard).c_str());
  }
}

TEST(UrController, TheSpeedSliderIsTheOneTheClientSets) {
  const hal::Descriptor socket = connect_to(sut->ports().rtde);
  using enum rtde::FieldType;
  rtde::ClientSession client{
      {.outputs = {{.variables = {{"target_speed_fraction", Double}}}},
       .inputs = {{{"speed_slider_mask", Uint32}, {"speed_slider_fraction", Double}}}}};
  struct Slider final : rtde::ClientListener {
    double ratio{-1};
    void on_data(std::size_t, std::span<const rtde::Value> values) override {
      ratio = std::get<double>(values[0]);
    }
    void on_text(const rtde::TextMessage&) override {}
  } slider;
  client.start();
  bool sent = false;
  for (int i = 0; i < k_patience_ms && slider.ratio != 0.25; ++i) {
    if (client.running() && !std::exchange(sent, true))
      client.send_inputs(0, std::vector<rtde::Value>{std::uint32_t{1}, 0.25});
    CHECK(write_available(socket, client.outgoing()));
    pollfd wait{socket.number(), POLLIN, 0};
    poll(&wait, 1, 1);
    std::vector<std::uint8_t> bytes;
    CHECK(read_available(socket, bytes));
    CHECK(client.consume(bytes, slider).has_value());
  }
  DOUBLES_EQUAL(0.25, slider.ratio, 0);
}

}  // namespace biteline::sim
