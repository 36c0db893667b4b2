// SPDX-License-Identifier: MIT
#include <array>
#include <string_view>

#include "common/config/yaml_reader.hpp"
#include "hal/board/board.hpp"

namespace biteline::hal {
namespace {

using config::YamlReader;

/// The place of the text under `key` among `names`; a fault and 0 when it is none of them.
template <std::size_t Count>
std::size_t choice(YamlReader& reader, const std::string& key,
                   const std::array<std::string_view, Count>& names) {
  const std::string text = reader.text(key);
  std::string expected;
  for (std::size_t i = 0; i < Count; ++i) {
    if (text == names[i]) return i;
    expected += (i == 0 ? "" : ", ") + std::string{names[i]};
  }
  if (!text.empty()) reader.fault(Errc::BadValue, key, "one of " + expected + " expected");
  return 0;
}

Nanoseconds microseconds(double us) {
  return Nanoseconds{static_cast<std::int64_t>(us * 1000)};
}

GpioLineAddress read_line(YamlReader& parent, const std::string& key) {
  YamlReader reader = parent.child(key, true);
  GpioLineAddress line{.chip = reader.text("chip"), .line = reader.text("line")};
  line.active_low = reader.boolean_or("active_low", false);
  const std::string bias = reader.text_or("bias", "as-is");
  if (bias == "pull-up") {
    line.bias = GpioLineAddress::Bias::PullUp;
  } else if (bias == "pull-down") {
    line.bias = GpioLineAddress::Bias::PullDown;
  } else if (bias == "disabled") {
    line.bias = GpioLineAddress::Bias::Disabled;
  } else if (bias != "as-is") {
    reader.fault(Errc::BadValue, "bias", "one of as-is, pull-up, pull-down, disabled expected");
  }
  return line;
}

std::optional<GpioLineAddress> read_optional_line(YamlReader& parent, const std::string& key) {
  if (!parent.has(key)) return std::nullopt;
  return read_line(parent, key);
}

BoardCamera read_camera(YamlReader& parent) {
  YamlReader reader = parent.child("camera", true);
  BoardCamera camera;
  if (choice<2>(reader, "kind", {"v4l2", "gige"}) == 0) {
    camera.kind = BoardCamera::Kind::V4l2;
    camera.device = reader.text("device");
    camera.control_device = reader.text_or("control_device", "");
    if (reader.has("gain")) camera.gain = static_cast<int>(reader.integer("gain", {0, 65535}));
    if (reader.has("readout_us")) camera.readout = microseconds(reader.number("readout_us", {0, 1e6}));
  } else {
    camera.kind = BoardCamera::Kind::GigE;
    camera.address = reader.text("address");
    // 576 is the least that every network carries; 65535 the most that UDP does.
    camera.packet_bytes = static_cast<int>(reader.integer_or("packet_bytes", 0, {0, 65535}));
    camera.packet_socket = reader.boolean_or("packet_socket", false);
  }
  camera.hardware_trigger = reader.boolean_or("hardware_trigger", false);
  if (reader.has("edge_to_mid_us")) {
    const std::vector<double> bounds_us = reader.numbers("edge_to_mid_us", 2);
    camera.edge_to_mid_min = microseconds(bounds_us[0]);
    camera.edge_to_mid_max = microseconds(bounds_us[1]);
    if (!(bounds_us[0] <= bounds_us[1] && bounds_us[1] <= 1e6)) {
      reader.fault(Errc::BadValue, "edge_to_mid_us", "[least, most] below 1e6 expected");
    }
  }
  return camera;
}

BoardEncoder read_encoder(YamlReader& reader) {
  BoardEncoder encoder;
  encoder.interface = reader.text("interface");
  encoder.node = static_cast<std::uint8_t>(reader.integer("node", {1, 127}));
  encoder.range_ticks = static_cast<std::uint32_t>(reader.integer_or("range_ticks", 0, {0, 0xFFFFFFFF}));
  return encoder;
}

BoardTrigger read_trigger(YamlReader& parent) {
  YamlReader reader = parent.child("trigger", false);
  if (!parent.has("trigger")) return {};
  BoardTrigger trigger;
  switch (choice<3>(reader, "kind", {"pwm", "software", "encoder"})) {
    case 0:
      trigger.kind = BoardTrigger::Kind::HardwareTimer;
      trigger.chip = reader.text("chip");
      trigger.channel = static_cast<int>(reader.integer("channel", {0, 63}));
      break;
    case 1:
      trigger.kind = BoardTrigger::Kind::Software;
      trigger.line = read_line(reader, "line");
      break;
    default:
      trigger.kind = BoardTrigger::Kind::Encoder;
      trigger.line = read_line(reader, "line");
      trigger.encoder = read_encoder(reader);
      trigger.pitch_ticks = reader.integer("pitch_ticks", {1, 1'000'000'000});
  }
  return trigger;
}

std::optional<BoardLaser> read_laser(YamlReader& parent) {
  if (!parent.has("laser")) return std::nullopt;
  YamlReader reader = parent.child("laser", true);
  BoardLaser laser;
  laser.enable = read_line(reader, "enable");
  laser.interlock = read_line(reader, "interlock");
  laser.key = read_optional_line(reader, "key");
  laser.heartbeat = read_optional_line(reader, "heartbeat");
  if (reader.has("temperature")) {
    YamlReader limit = reader.child("temperature", true);
    laser.temperature = limit.text("file");
    laser.temperature_max_degc = limit.number("max_degc", {-20, 120});
  }
  if (reader.has("patience_ms"))
    laser.patience = microseconds(1000 * reader.number("patience_ms", {50, 60'000}));
  return laser;
}

BoardPoses read_poses(YamlReader& parent) {
  YamlReader reader = parent.child("poses", true);
  BoardPoses poses;
  const std::size_t kind = choice<6>(reader, "kind", {"rtde", "can", "encoder", "egm", "rsi", "arm_link"});
  if (kind == 2) {
    poses.kind = BoardPoses::Kind::Encoder;
    poses.encoder = read_encoder(reader);
    const std::vector<double> mm = reader.numbers("per_tick_mm", 3), rad = reader.numbers("per_tick_rad", 3);
    for (int i = 0; i < 3; ++i) {
      poses.per_tick[i] = mm[static_cast<std::size_t>(i)];
      poses.per_tick[i + 3] = rad[static_cast<std::size_t>(i)];
    }
  } else if (kind == 0) {
    poses.kind = BoardPoses::Kind::Rtde;
    poses.address = reader.text("address");
    poses.port = static_cast<std::uint16_t>(reader.integer_or("port", 30004, {1, 65535}));
    poses.rate_hz = reader.number_or("rate_hz", 500, {1, 500});
  } else if (kind == 5) {
    poses.kind = BoardPoses::Kind::ArmLink;
    poses.address = reader.text("address");
    poses.port = static_cast<std::uint16_t>(reader.integer_or("port", 30401, {1, 65535}));
  } else if (kind >= 3) {
    poses.kind = kind == 3 ? BoardPoses::Kind::Egm : BoardPoses::Kind::Rsi;
    poses.address = reader.text("address");
    poses.port = static_cast<std::uint16_t>(reader.integer("port", {1, 65535}));
    if (kind == 4) poses.answers = reader.boolean_or("answers", true);
  } else {
    poses.kind = BoardPoses::Kind::Can;
    poses.interface = reader.text("interface");
    poses.base_id = static_cast<std::uint32_t>(reader.integer_or("base_id", 0x1A0, {0, 0x7F4}));
    if (poses.base_id % 4 != 0) reader.fault(Errc::BadValue, "base_id", "a multiple of 4 expected");
  }
  return poses;
}

BoardWatchdog read_watchdog(YamlReader& parent) {
  YamlReader reader = parent.child("watchdog", true);
  BoardWatchdog watchdog;
  watchdog.device = reader.text_or("device", "");
  watchdog.systemd = reader.boolean_or("systemd", true);
  watchdog.timeout = microseconds(1000 * reader.number("timeout_ms", {50, 600'000}));
  return watchdog;
}

/// The first key whose address means simulated wires; empty: none.
std::string simulated_wires(const Board& board) {
  const auto is_simulated = [](const std::string& address) { return address.starts_with(k_simulated_wires); };
  if (is_simulated(board.trigger.chip) || is_simulated(board.trigger.line.chip)) return "trigger";
  if (is_simulated(board.trigger.encoder.interface)) return "trigger";
  if (is_simulated(board.poses.interface) || is_simulated(board.poses.encoder.interface)) return "poses";
  if (board.strobe_echo && is_simulated(board.strobe_echo->chip)) return "strobe_echo";
  if (board.scan_active && is_simulated(board.scan_active->chip)) return "scan_active";
  if (!board.laser) return "";
  const bool laser = is_simulated(board.laser->enable.chip) || is_simulated(board.laser->interlock.chip) ||
                     (board.laser->key && is_simulated(board.laser->key->chip)) ||
                     (board.laser->heartbeat && is_simulated(board.laser->heartbeat->chip));
  return laser ? "laser" : "";
}

}  // namespace

Result<Board> read_board_yaml(const std::filesystem::path& path) {
  BITELINE_ASSIGN(YamlReader reader, YamlReader::open(path));
  Board board;
  board.name = reader.text("board");
  board.simulated = reader.boolean_or("simulated", false);
  board.camera = read_camera(reader);
  board.trigger = read_trigger(reader);
  board.laser = read_laser(reader);
  board.strobe_echo = read_optional_line(reader, "strobe_echo");
  board.scan_active = read_optional_line(reader, "scan_active");
  board.poses = read_poses(reader);
  board.ptp = reader.text_or("ptp", "");
  board.watchdog = read_watchdog(reader);

  if (board.trigger.kind != BoardTrigger::Kind::None && !board.camera.hardware_trigger) {
    reader.fault(Errc::BadValue, "trigger", "camera.hardware_trigger: true expected beside it");
  }
  if (board.camera.edge_to_mid_max > Nanoseconds{0} && !board.strobe_echo) {
    reader.fault(Errc::BadValue, "camera", "strobe_echo expected beside edge_to_mid_us");
  }
  if (board.laser && board.laser->patience && !board.simulated) {
    reader.fault(Errc::BadValue, "laser", "patience_ms only beside simulated: true");
  }
  if (const std::string key = simulated_wires(board); !key.empty() && !board.simulated) {
    reader.fault(Errc::BadValue, key, "sim: addresses only beside simulated: true");
  }
  BITELINE_TRY(reader.finish());
  return board;
}

}  // namespace biteline::hal
