// SPDX-License-Identifier: MIT
// The real programs against each other, killed, locked out, fed rubbish: what each of them says, and that
// nothing is lost.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/wire/socket.hpp"
#include "host/intake/cloud_builder.hpp"
#include "host/intake/sensor_link.hpp"
#include "host/intake/sensor_process.hpp"
#include "host/intake/session_run.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/key_set.hpp"
#include "tests/support/made_session.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::intake {
namespace {

namespace fs = std::filesystem;
using intake::ChildProcess;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds k_patience{30};  // of a loaded machine; nothing here takes a second by itself

fs::path program(const char* name) {
  return find_sensor_program()->parent_path() / name;
}

/// Collects one scan; steps from outside, so that several can run side by side.
struct Collector {
  std::unique_ptr<SensorLink> link;
  std::uint64_t profiles{0};
  std::uint64_t lost{0};
  bool ended{false};
  wire::EndOfScan end;
  std::optional<Error> error;

  void step() {
    const auto event = link->next(milliseconds{20});
    if (!event) {
      error = event.error();
      return;
    }
    if (!*event) return;
    if (const auto* profile = std::get_if<ProfileEvent>(&**event)) {
      LONGS_EQUAL(profiles, profile->profile.header.sequence);
      ++profiles;
    }
    if (const auto* loss = std::get_if<LossEvent>(&**event)) lost += loss->messages;
    if (const auto* over = std::get_if<wire::EndOfScan>(&**event)) {
      end = *over;
      ended = true;
    }
  }
  void run() {
    const auto deadline = std::chrono::steady_clock::now() + k_patience;
    while (!ended && !error && std::chrono::steady_clock::now() < deadline) step();
  }
};

}  // namespace

TEST_GROUP(SensorAndHosts) {
  test::TemporaryFolder folder;
  test::MadeSession made{.frames = 150, .width_px = 160, .height_px = 96};

  void setup() override {
    test::write_made_session(made, session());
  }
  fs::path session() const {
    return folder.path() / "made";
  }

  Result<SensorProcess> start_sensor(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"--source", "replay:" + session().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return SensorProcess::start(*find_sensor_program(), arguments, k_patience);
  }
  static SensorLinkConfig config_for(const wire::Endpoint& sensor, std::optional<wire::HostKeys> keys = {}) {
    SensorLinkConfig config;
    config.sensor = sensor;
    config.keys = std::move(keys);
    config.silence_limit = seconds{5};
    return config;
  }
  static Collector collector(const SensorLinkConfig& config) {
    auto link = SensorLink::open(config);
    SUCCEEDS(link);
    return {.link = std::move(*link), .end = {}, .error = {}};
  }
  ChildProcess start_host(const wire::Endpoint& sensor) const {
    auto host = ChildProcess::start(
        {.program = program("biteline-host"),
         .arguments = {"--sensor", sensor.text(), "--out", results().string(), "--once"}});
    SUCCEEDS(host);
    return std::move(*host);
  }
  fs::path results() const {
    return folder.path() / "results";
  }
  nlohmann::json report() const {
    std::ifstream stream{results() / "scan-0001" / "report.json"};
    return test::read_json(stream);
  }
};

TEST(SensorAndHosts, SecondHostInTheMiddleOfAScanLosesNothingAndNeitherDoesTheFirst) {
  auto sensor = start_sensor();
  SUCCEEDS(sensor);
  Collector first = collector(config_for(sensor->endpoint()));
  while (first.profiles < 40 && !first.error) first.step();
  Collector second = collector(config_for(sensor->endpoint()));
  while (!(first.ended && second.ended) && !first.error && !second.error) {
    if (!first.ended) first.step();
    if (!second.ended) second.step();
  }
  CHECK(!first.error && !second.error);
  LONGS_EQUAL(made.frames, first.profiles);
  LONGS_EQUAL(made.frames, second.profiles);
  LONGS_EQUAL(0, first.lost + second.lost);
}

TEST(SensorAndHosts, SensorLeavesByItselfOnceARecordingIsDelivered) {
  auto sensor = start_sensor();
  SUCCEEDS(sensor);
  {
    Collector host = collector(config_for(sensor->endpoint()));
    host.run();
    CHECK(host.ended);
  }
  const auto status = sensor->child().wait(k_patience);
  SUCCEEDS(status);
  LONGS_EQUAL(0, *status);
}

TEST(SensorAndHosts, ServiceKilledInTheMiddleOfAScanGoesOnWhereItStood) {
  made.frames = 600;
  fs::remove_all(session());
  test::write_made_session(made, session());
  auto sensor = start_sensor({"--stay"});
  SUCCEEDS(sensor);
  {
    ChildProcess host = start_host(sensor->endpoint());
    const fs::path journal = results() / "scan-0001" / "scan.btln";
    std::error_code error;
    // Some forty profiles of 4 KB.
    while (host.running() && !(fs::exists(journal, error) && fs::file_size(journal, error) > 160'000))
      std::this_thread::yield();
    ::kill(host.pid(), SIGKILL);
    (void)host.wait(k_patience);
  }
  CHECK(!fs::exists(results() / "scan-0001" / "report.json"));
  ChildProcess successor = start_host(sensor->endpoint());
  const auto line = successor.next_line(k_patience);
  SUCCEEDS(line);
  STRCMP_CONTAINS("found scan-0001 unfinished", line->c_str());
  const auto status = successor.wait(k_patience);
  SUCCEEDS(status);
  // There is no shoe in the made session: the whole cloud is there, and the line is refused.
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), *status);
  const nlohmann::json told = report();
  STRCMP_EQUAL("refused", told.value("status", "").c_str());
  LONGS_EQUAL(made.frames, told["scan"].value("profiles", 0));
  LONGS_EQUAL(0, told["scan"].value("profiles_lost", -1));
  LONGS_EQUAL(0, told.value("messages_lost", -1));
  // Its messages stay, so that somebody can look at why; and so does a picture of what was scanned.
  CHECK(fs::exists(results() / "scan-0001" / "scan.btln"));
  CHECK(fs::exists(results() / "scan-0001" / "view_data.js"));
  CHECK(!fs::exists(results() / "scan-0001" / "line.csv"));
}

TEST(SensorAndHosts, FullDiskEndsTheServiceAndItsSuccessorLosesNothing) {
  auto sensor = start_sensor({"--stay"});
  SUCCEEDS(sensor);
  // A limit on files instead of a full disk: 600 blocks of 512 bytes take the empty memory of the cell, and
  // some seventy of the 150 profiles.
  auto host =
      ChildProcess::start({.program = "/bin/sh",
                           .arguments = {"-c", "trap '' XFSZ; ulimit -f 600; exec \"$@\"", "sh",
                                         program("biteline-host").string(), "--sensor",
                                         sensor->endpoint().text(), "--out", results().string(), "--once"}});
  SUCCEEDS(host);
  const auto full = host->wait(k_patience);
  SUCCEEDS(full);
  LONGS_EQUAL(static_cast<int>(error_row(Errc::DiskFull).exit_status), *full);
  STRCMP_CONTAINS("scan.btln", host->last_words().c_str());

  ChildProcess successor = start_host(sensor->endpoint());
  SUCCEEDS(successor.wait(k_patience));
  const nlohmann::json told = report();
  LONGS_EQUAL(made.frames, told["scan"].value("profiles", 0));
  LONGS_EQUAL(0, told["scan"].value("profiles_lost", -1));
  LONGS_EQUAL(0, told.value("messages_lost", -1));
}

TEST(SensorAndHosts, ServiceWithTooLittleMemoryEndsInWordsAndNotByASignal) {
  auto sensor = start_sensor({"--stay"});
  SUCCEEDS(sensor);
  // Of address space; below that the libraries themselves do not load.
  for (int limit_kb = 300'000; limit_kb <= 600'000; limit_kb += 50'000) {
    const fs::path out = folder.path() / std::to_string(limit_kb), errors = out.string() + ".err";
    auto host = ChildProcess::start(
        {.program = "/bin/sh",
         .arguments = {"-c", "ulimit -v " + std::to_string(limit_kb) + "; exec \"$@\" 2>" + errors.string(),
                       "sh", program("biteline-host").string(), "--sensor", sensor->endpoint().text(),
                       "--out", out.string(), "--once"}});
    SUCCEEDS(host);
    const auto status = host->wait(k_patience);
    SUCCEEDS(status);
    const std::string name = "ulimit -v " + std::to_string(limit_kb);
    CHECK_TEXT(*status == 0 || *status == 3 || *status == 4, (name + ": " + std::to_string(*status)).c_str());
    std::ifstream stream{errors};
    const std::string said{std::istreambuf_iterator<char>{stream}, {}};
    CHECK_TEXT(std::ranges::count(said, '\n') <= 2, (name + ": " + said).c_str());
  }
}

TEST(SensorAndHosts, KilledSensorIsToldAtOnceToWhoStartedIt) {
  // A sensor whose process number the test learns.
  SessionRunOptions options;
  options.session = session();
  const fs::path pid_file = folder.path() / "pid";
  options.program = folder.write("sensor.sh", "#!/bin/sh\necho $$ > " + pid_file.string() + "\nexec " +
                                                  find_sensor_program()->string() + " \"$@\"\n");
  fs::permissions(*options.program, fs::perms::owner_all);
  int taken = 0;
  options.on_profile = [&](const profile::Profile&, auto&&...) {
    if (++taken != 5) return;
    int pid = 0;
    std::ifstream{pid_file} >> pid;
    ::kill(pid, SIGKILL);
  };
  const auto run = run_sensor_on_session(options);
  // What was under way may still arrive, but never the end.
  FAILS_NAMING(Errc::ProcessDied, "Killed", run);
}

TEST(SensorAndHosts, ServiceSaysThatTheSensorIsGone) {
  auto sensor = start_sensor({"--stay"});
  SUCCEEDS(sensor);
  const wire::Endpoint address = sensor->endpoint();
  ::kill(sensor->child().pid(), SIGKILL);
  (void)sensor->child().wait(k_patience);
  ChildProcess host = start_host(address);
  const auto status = host.wait(k_patience);
  SUCCEEDS(status);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Connection), *status);
  STRCMP_CONTAINS("no sensor answers at", host.last_words().c_str());
}

TEST(SensorAndHosts, SensorToldToStopSaysSoAndEndsWell) {
  auto sensor = start_sensor({"--stay"});
  SUCCEEDS(sensor);
  Collector host = collector(config_for(sensor->endpoint()));
  host.run();
  CHECK(host.ended);
  Collector late = collector(config_for(sensor->endpoint()));
  while (late.profiles < 10 && !late.error) late.step();
  LONGS_EQUAL(0, sensor->child().stop());
  late.run();
  // Either the rest was already under way, or the sensor's farewell says why it ended.
  if (!late.ended) STRCMP_CONTAINS("told to stop", to_line(*late.error).c_str());
}

TEST(SensorAndHosts, KeysLetTheRightHostInAndKeepOthersOut) {
  SUCCEEDS(test::make_key_set(folder.path() / "keys"));
  SUCCEEDS(test::make_key_set(folder.path() / "other"));
  const wire::HostKeys right = *wire::read_host_keys(folder.path() / "keys");
  wire::HostKeys stranger = *wire::read_host_keys(folder.path() / "other");
  stranger.sensor_public_key = right.sensor_public_key;
  wire::HostKeys wrong_sensor = right;
  wrong_sensor.sensor_public_key = wire::read_host_keys(folder.path() / "other")->sensor_public_key;

  auto sensor = start_sensor({"--keys", (folder.path() / "keys").string(), "--stay"});
  SUCCEEDS(sensor);
  Collector refused = collector(config_for(sensor->endpoint(), stranger));
  refused.run();
  CHECK(refused.error.has_value());
  LONGS_EQUAL(static_cast<int>(Errc::AuthenticationFailed), static_cast<int>(refused.error->code));
  LONGS_EQUAL(0, refused.profiles);

  for (const std::optional<wire::HostKeys>& keys :
       {std::optional<wire::HostKeys>{wrong_sensor}, std::optional<wire::HostKeys>{}}) {
    SensorLinkConfig config = config_for(sensor->endpoint(), keys);
    config.silence_limit = milliseconds{700};
    Collector locked_out = collector(config);
    locked_out.run();
    CHECK(locked_out.error.has_value());
    LONGS_EQUAL(0, locked_out.profiles);
  }

  Collector welcome = collector(config_for(sensor->endpoint(), right));
  welcome.run();
  CHECK(welcome.ended);
  LONGS_EQUAL(made.frames, welcome.profiles);
}

TEST(SensorAndHosts, BeyondLoopbackNothingGoesWithoutKeys) {
  const auto sensor = start_sensor({"--listen", "tcp://0.0.0.0:0"});
  CHECK(!sensor);
  STRCMP_CONTAINS("keys are compulsory", to_line(sensor.error()).c_str());
  const auto link = SensorLink::open(config_for({.host = "192.0.2.1", .port = 5}));
  FAILS_NAMING(Errc::AuthenticationFailed, "keys are compulsory", link);
}

TEST(SensorAndHosts, RealTimeIsRefusedWithoutTheRightsAndSaysHowToGoOn) {
  // Root without its capabilities has the rights of anybody.
  const std::string script =
      R"sh(ulimit -r 0; [ "$(id -u)" = 0 ] && drop="setpriv --bounding-set=-all --inh-caps=-all"; exec $drop "$@")sh";
  auto sensor =
      ChildProcess::start({.program = "/bin/bash",
                           .arguments = {"-c", script, "sh", program("biteline-sensor").string(), "--source",
                                         "replay:" + session().string(), "--rt=required"}});
  SUCCEEDS(sensor);
  const auto status = sensor->wait(k_patience);
  SUCCEEDS(status);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Connection), *status);
  STRCMP_CONTAINS("--rt=ignore", sensor->last_words().c_str());
}

TEST(SensorAndHosts, CheckOfABoardHasOneStepForEachThingThatIsMissing) {
  const fs::path board = folder.write(
      "board.yaml",
      "board: a\ncamera: {kind: v4l2, device: /dev/none}\n"
      "laser: {enable: {chip: none, line: '1', bias: pull-down}, interlock: {chip: none, line: '2'}}\n"
      "poses: {kind: can, interface: none0}\nptp: /dev/none\nwatchdog: {device: /dev/none, timeout_ms: "
      "500}\n");
  auto sensor = ChildProcess::start({.program = program("biteline-sensor"),
                                     .arguments = {"--check", "--source", "board:" + board.string()}});
  SUCCEEDS(sensor);
  int missing = 0;
  while (const auto line = sensor->next_line(k_patience)) {
    const bool is_missing = line->starts_with("missing\t");
    CHECK(is_missing || line->starts_with("ready\t"));
    CHECK_EQUAL(is_missing, line->back() != '\t');
    missing += is_missing ? 1 : 0;
  }
  CHECK(
      missing >=
      6);  // camera, laser enable, interlock, poses, PTP clock, watchdog; rights and kernel as they are here
  const auto status = sensor->wait(k_patience);
  SUCCEEDS(status);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Connection), *status);
}

TEST(SensorAndHosts, RubbishAndOtherVersionsDisturbNobody) {
  auto sensor = start_sensor({"--stay"});
  SUCCEEDS(sensor);
  auto context = wire::SocketContext::create();
  auto intruder = wire::open_caller(*context, sensor->endpoint(), {});
  SUCCEEDS(intruder);
  SUCCEEDS(intruder->connect(sensor->endpoint().text()));
  const wire::Bytes rubbish(300, 0x42);
  wire::Bytes other_version;
  wire::encode({.protocol = wire::k_protocol + 1, .body = wire::HostHello{}}, other_version);
  int sent = 0;
  const auto deadline = std::chrono::steady_clock::now() + k_patience;
  while (sent < 20 && std::chrono::steady_clock::now() < deadline) {
    sent += intruder->send({rubbish}) ? 1 : 0;
    (void)intruder->send({rubbish, rubbish, rubbish});
  }
  while (!intruder->send({other_version})) std::this_thread::yield();

  Collector host = collector(config_for(sensor->endpoint()));
  host.run();
  CHECK(host.ended);
  LONGS_EQUAL(made.frames, host.profiles);

  std::optional<wire::Socket::Parts> answer;
  while (!answer && std::chrono::steady_clock::now() < deadline) {
    wire::wait_readable({&*intruder}, milliseconds{20});
    answer = intruder->receive();
  }
  CHECK(answer.has_value());
  const auto bye = wire::decode(answer->parts.at(0));
  SUCCEEDS(bye);
  CHECK(std::get<wire::Bye>(bye->body).reason == wire::ByeReason::VersionMismatch);

  // The next health message counts them.
  std::uint64_t rejected = 0;
  while (rejected < 20 && std::chrono::steady_clock::now() < deadline) {
    const auto event = host.link->next(milliseconds{20});
    SUCCEEDS(event);
    if (!*event) continue;
    if (const auto* health = std::get_if<wire::Health>(&**event))
      rejected = health->counters.packets_rejected;
  }
  CHECK(rejected >= 20);
}

}  // namespace biteline::intake
