// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "hal/board/board.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

const std::string k_small = R"(board: made
camera: {kind: v4l2, device: /dev/video0}
poses: {kind: rtde, address: 192.168.1.10}
watchdog: {timeout_ms: 500}
)";

TEST_GROUP(BoardYaml) {
  fs::path file{fs::temp_directory_path() / ("biteline-board-" + std::to_string(::getpid()) + ".yaml")};

  void teardown() override {
    fs::remove(file);
  }
  Result<Board> read(const std::string& text) {
    std::ofstream{file} << text;
    return read_board_yaml(file);
  }
};

TEST(BoardYaml, EveryBoardOfTheTreeReads) {
  int boards = 0;
  for (const fs::directory_entry& folder : fs::directory_iterator{BITELINE_BOARDS_DIR}) {
    const fs::path path = folder.path() / "board.yaml";
    if (!fs::exists(path)) continue;
    const Result<Board> board = read_board_yaml(path);
    if (!board) FAIL(to_line(board.error()).c_str());
    CHECK(board->name == folder.path().filename().string());
    CHECK(board->laser.has_value());
    // A laser whose enable line floats, or is pulled the wrong way, is on before we are.
    CHECK(board->laser->enable.bias == (board->laser->enable.active_low ? GpioLineAddress::Bias::PullUp
                                                                        : GpioLineAddress::Bias::PullDown));
    // Some kernels leave a released output as it was: a real laser needs edges as well.
    CHECK(board->simulated || board->laser->heartbeat.has_value());
    ++boards;
  }
  CHECK(boards >= 4);
}

TEST(BoardYaml, LeastBoardHasItsDefaults) {
  const Result<Board> board = read(k_small);
  CHECK(board.has_value());
  CHECK(board->trigger.kind == BoardTrigger::Kind::None);
  CHECK_FALSE(board->laser.has_value());
  CHECK_EQUAL(30004, board->poses.port);
  CHECK(board->watchdog.timeout == 500ms);
}

TEST(BoardYaml, EncoderIsATriggerAndAPoseSource) {
  const Result<Board> board = read(
      "board: a\ncamera: {kind: v4l2, device: b, hardware_trigger: true}\n"
      "trigger: {kind: encoder, line: {chip: c, line: '3'}, interface: can0, node: 5, pitch_ticks: 40}\n"
      "poses: {kind: encoder, interface: can1, node: 6, range_ticks: 65536, per_tick_mm: [0.01, 0, 0], "
      "per_tick_rad: [0, 0, 0.002]}\nwatchdog: {timeout_ms: 500}\n");
  CHECK(board.has_value());
  CHECK(board->trigger.kind == BoardTrigger::Kind::Encoder);
  CHECK_EQUAL(40, board->trigger.pitch_ticks);
  CHECK_EQUAL(5, board->trigger.encoder.node);
  CHECK(board->poses.kind == BoardPoses::Kind::Encoder);
  CHECK_EQUAL(65536U, board->poses.encoder.range_ticks);
  DOUBLES_EQUAL(0.01, board->poses.per_tick[0], 0);
  DOUBLES_EQUAL(0.002, board->poses.per_tick[5], 0);
}

TEST(BoardYaml, FaultsAreRefusedEach) {
  struct Row {
    const char* name;
    std::string text;
    Errc expected;
  };
  const auto with = [](const char* line) { return k_small + line + "\n"; };
  const Row rows[] = {
      {"unknown key", with("colour: red"), Errc::UnknownKey},
      {"unknown key inside",
       with("laser: {enable: {chip: a, line: '1', volts: 5}, interlock: {chip: a, line: '2'}}"),
       Errc::UnknownKey},
      {"another kind's key",
       "board: a\ncamera: {kind: gige, address: a, device: b}\nposes: {kind: rtde, address: a}\n"
       "watchdog: {timeout_ms: 500}\n",
       Errc::UnknownKey},
      {"unknown kind",
       "board: a\ncamera: {kind: usb, device: b}\nposes: {kind: rtde, address: a}\n"
       "watchdog: {timeout_ms: 500}\n",
       Errc::BadValue},
      {"missing camera", "board: a\nposes: {kind: rtde, address: a}\nwatchdog: {timeout_ms: 500}\n",
       Errc::BadFormat},
      {"wild bias", with("scan_active: {chip: a, line: '1', bias: up}"), Errc::BadValue},
      {"a patient guard of a real laser",
       with("laser: {enable: {chip: a, line: '1'}, interlock: {chip: a, line: '2'}, patience_ms: 5000}"),
       Errc::BadValue},
      {"trigger on a camera that takes none", with("trigger: {kind: pwm, chip: a, channel: 0}"),
       Errc::BadValue},
      {"base id off the grid",
       "board: a\ncamera: {kind: v4l2, device: b}\nposes: {kind: can, interface: c, base_id: 3}\n"
       "watchdog: {timeout_ms: 500}\n",
       Errc::BadValue},
      {"watchdog too short",
       "board: a\ncamera: {kind: v4l2, device: b}\nposes: {kind: rtde, address: a}\n"
       "watchdog: {timeout_ms: 1}\n",
       Errc::BadValue},
  };
  for (const Row& row : rows) {
    const Result<Board> board = read(row.text);
    if (board) FAIL(row.name);
    if (board.error().code != row.expected && row.expected != Errc::BadFormat)
      FAIL((row.name + (": " + to_line(board.error()))).c_str());
  }
}

TEST(BoardYaml, PosesOfOtherMakersHaveTheControllersAddressAndOurPort) {
  const auto with = [this](const char* poses) {
    return read("board: a\ncamera: {kind: v4l2, device: b}\nposes: " + std::string{poses} +
                "\nwatchdog: {timeout_ms: 500}\n");
  };
  const Result<Board> egm = with("{kind: egm, address: 192.168.125.1, port: 6510}");
  CHECK(egm.has_value());
  CHECK(egm->poses.kind == BoardPoses::Kind::Egm);
  STRCMP_EQUAL("192.168.125.1", egm->poses.address.c_str());
  CHECK_EQUAL(6510, egm->poses.port);
  const Result<Board> link = with("{kind: arm_link, address: 192.168.125.1}");
  CHECK(link->poses.kind == BoardPoses::Kind::ArmLink);
  STRCMP_EQUAL("192.168.125.1", link->poses.address.c_str());
  CHECK_EQUAL(30401, link->poses.port);
  CHECK_EQUAL(7, with("{kind: arm_link, address: 192.168.125.1, port: 7}")->poses.port);
  CHECK_FALSE(with("{kind: arm_link, port: 7}").has_value());
  CHECK_FALSE(with("{kind: arm_link, address: 192.168.125.1, answers: true}").has_value());
  const Result<Board> rsi = with("{kind: rsi, address: 192.168.1.20, port: 49152}");
  CHECK(rsi->poses.kind == BoardPoses::Kind::Rsi);
  CHECK(rsi->poses.answers);
  CHECK_FALSE(with("{kind: rsi, address: 192.168.1.20, port: 49152, answers: false}")->poses.answers);
  CHECK_FALSE(with("{kind: egm, address: 192.168.1.20, port: 49152, answers: false}").has_value());
  CHECK_FALSE(with("{kind: rsi, address: 192.168.1.20}").has_value());
  CHECK_FALSE(with("{kind: egm, address: 192.168.125.1, port: 6510, rate_hz: 250}").has_value());
}

TEST(BoardYaml, SimulatedWiresNeedABoardThatSaysSo) {
  const std::string lines =
      "camera: {kind: v4l2, device: /dev/video0}\nposes: {kind: can, interface: 'sim:cell'}\n"
      "watchdog: {timeout_ms: 500}\n";
  const Result<Board> refused = read("board: a\n" + lines);
  CHECK(!refused.has_value());
  CHECK(to_line(refused.error()).find("simulated: true") != std::string::npos);
  CHECK(read("board: a\nsimulated: true\n" + lines).has_value());
}

}  // namespace
}  // namespace biteline::hal
