// SPDX-License-Identifier: MIT
#include "firmware/app/board_check.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

#include "common/config/sensor_yaml.hpp"
#include "firmware/app/backends/backend.hpp"
#include "firmware/app/board_devices.hpp"
#include "firmware/app/camera_look.hpp"
#include "firmware/runtime/realtime.hpp"
#include "hal/linux/posix/descriptor.hpp"
#include "hal/linux/ptp/phc.hpp"

namespace biteline::sensor {
namespace {

template <class T>
DeviceFinding finding(std::string what, const Result<T>& opened, const char* step) {
  if (opened) return {.what = std::move(what), .ready = true, .seen = "answers", .step = {}};
  return {.what = std::move(what), .ready = false, .seen = to_line(opened.error()), .step = step};
}

std::string name_of(const char* what, const hal::GpioLineAddress& line) {
  return std::string{what} + " (" + line.chip + " " + line.line + ")";
}

Result<hal::RobotPose> first_pose(Result<std::unique_ptr<hal::PoseSource>> poses) {
  constexpr Nanoseconds k_patience = std::chrono::seconds{1};
  if (!poses) return tl::unexpected<Error>{poses.error()};
  BITELINE_TRY((*poses)->start());
  Result<hal::RobotPose> pose = (*poses)->next_pose(k_patience);
  if (pose || pose.error().code != Errc::Timeout) return pose;
  // Nobody was there to answer: that is no answer that is late.
  if (const std::optional<Error> fault = (*poses)->fault()) return tl::unexpected<Error>{*fault};
  return pose;
}

const std::string& interface_of(const hal::BoardPoses& poses) {
  return poses.kind == hal::BoardPoses::Kind::Encoder ? poses.encoder.interface : poses.interface;
}

/// What to do where no pose comes.
std::string step_for_poses(const hal::BoardPoses& poses, const Result<hal::RobotPose>& pose) {
  const std::string to_us = "to this machine's UDP port " + std::to_string(poses.port);
  switch (poses.kind) {
    case hal::BoardPoses::Kind::Rtde:
      return !pose && pose.error().code == Errc::PeerRefused
                 ? "update the controller's software: PolyScope 3.12.3 or 5.5.1 at least"
                 : "switch the controller on, check the cable, and allow RTDE in its settings";
    case hal::BoardPoses::Kind::Egm:
      return "start a program that streams the pose of tool0 in wobj0 (EGMStreamStart) " + to_us;
    case hal::BoardPoses::Kind::Rsi:
      return "start a program that switches RSI on, with DEF_RIst, " + to_us;
    case hal::BoardPoses::Kind::ArmLink:
      return "start the program's task that tells states at the controller's port " +
             std::to_string(poses.port);
    case hal::BoardPoses::Kind::Can:
    case hal::BoardPoses::Kind::Encoder:
      break;
  }
  return "ip link set " + interface_of(poses) +
         " up type can bitrate 500000 dbitrate 2000000 fd on restart-ms 100, and start what sends on it";
}

/// The rights, tried out on a thread that ends at once.
Result<void> try_realtime() {
  BITELINE_TRY(runtime::prepare_process(runtime::RealtimeDemand::Required));
  Result<void> entered;
  std::thread{[&] {
    entered = runtime::enter_thread(runtime::threads::k_safety, runtime::RealtimeDemand::Required);
  }}.join();
  return entered;
}

/// A camera's own words tell the step where its cause is known; this is for the others.
const char* camera_step(const Error& error, bool is_gige) {
  if (error.code == Errc::Refused)
    return "switch off what sets the camera otherwise (power off and on clears it), or calibrate it as it is";
  if (is_gige) {
    return error.code == Errc::Timeout
               ? "check the trigger's wire, and let one network card carry packets as large as packet_bytes"
               : "check the camera's cable, power and address, and that its port has an address in the same "
                 "net";
  }
  switch (error.code) {
    case Errc::NotSupported:
      return "a monochrome sensor, or a driver that gives its grey pictures in one plane: v4l2-ctl "
             "--list-formats-ext";
    case Errc::NoRights:
      return "join the group video";
    case Errc::DeviceError:
      return "mend what it says, then run this again";
    case Errc::Timeout:
      return "check the trigger's wire and the camera's cable";
    case Errc::BadValue:
      return "v4l2-ctl --list-formats-ext tells its sizes; mend region or exposure, or the size that was set";
    default:
      return "load the board's overlay and check the camera's cable; join the group video";
  }
}

DeviceFinding camera_finding(const BoardDevices& devices, const std::optional<geometry::SensorModel>& head) {
  const hal::BoardCamera& camera = devices.board().camera;
  const bool is_gige = camera.kind == hal::BoardCamera::Kind::GigE;
  DeviceFinding found{.what = "camera (" + (is_gige ? camera.address : camera.device) + ")",
                      .ready = false,
                      .seen = {},
                      .step = {}};
  // Held dark meanwhile, whatever hangs on the camera's strobe.
  const std::optional<hal::BoardLaser>& laser = devices.board().laser;
  const Result<std::unique_ptr<hal::GpioOut>> dark =
      laser ? open_output(laser->enable) : Result<std::unique_ptr<hal::GpioOut>>{};
  if (const Result<std::string> seen = look_through_camera(devices, head)) {
    found.ready = true;
    found.seen = "answers: " + *seen;
  } else {
    found.seen = to_line(seen.error());
    found.step = camera_step(seen.error(), is_gige);
  }
  return found;
}

std::vector<DeviceFinding> examine(const BoardDevices& devices,
                                   const std::optional<geometry::SensorModel>& head) {
  const hal::Board& board = devices.board();
  constexpr const char* k_line_step =
      "load the board's overlay, stop biteline-sensor, and compare chip and line with gpioinfo";
  std::vector<DeviceFinding> found;
  const Result<std::int64_t> preempt_rt = hal::read_integer("/sys/kernel/realtime");
  const bool is_realtime = preempt_rt && *preempt_rt == 1;
  found.push_back({.what = "real-time kernel",
                   .ready = is_realtime,
                   .seen = is_realtime ? "PREEMPT_RT" : "a plain kernel",
                   .step = is_realtime ? "" : "apt-get install linux-image-rt-arm64, and boot it"});
  found.push_back(
      finding("real-time rights and locked memory", try_realtime(),
              "start it by its systemd unit, or set LimitRTPRIO and LimitMEMLOCK; --rt=ignore runs without"));
  found.push_back(camera_finding(devices, head));
  if (board.trigger.kind != hal::BoardTrigger::Kind::None) {
    found.push_back(finding("trigger (" + board.trigger.chip + board.trigger.line.chip + ")",
                            devices.open_trigger(),
                            "load the board's overlay and install its udev rules for the group biteline"));
  }
  if (board.laser) {
    found.push_back(
        finding(name_of("laser enable", board.laser->enable), open_output(board.laser->enable), k_line_step));
    if (board.laser->heartbeat) {
      found.push_back(finding(name_of("heartbeat", *board.laser->heartbeat),
                              open_output(*board.laser->heartbeat), k_line_step));
    }
    found.push_back(
        finding(name_of("interlock", board.laser->interlock), open_safety(*board.laser), k_line_step));
  }
  if (board.strobe_echo && board.camera.edge_to_mid_max == Nanoseconds{0}) {
    found.push_back(
        finding(name_of("strobe echo", *board.strobe_echo), open_edges(*board.strobe_echo), k_line_step));
  }
  if (board.scan_active) {
    found.push_back(
        finding(name_of("scan active", *board.scan_active), open_edges(*board.scan_active), k_line_step));
  }
  const Result<hal::RobotPose> pose = first_pose(devices.open_poses());
  const std::string step = step_for_poses(board.poses, pose);
  const bool by_wire = board.poses.address.empty();
  found.push_back(finding("poses (" + (by_wire ? interface_of(board.poses) : board.poses.address) + ")", pose,
                          step.c_str()));
  if (!board.ptp.empty()) {
    const Result<hal::Phc> clock = hal::Phc::open(board.ptp);
    found.push_back(
        finding("PTP clock (" + board.ptp + ")",
                clock ? clock->measure().map([](const auto&) {}) : tl::unexpected<Error>{clock.error()},
                "enable the network port's hardware clock and start ptp4l on it"));
  }
  if (!board.watchdog.device.empty()) {
    const bool writable = ::access(board.watchdog.device.c_str(), W_OK) == 0;
    found.push_back(
        {.what = "watchdog (" + board.watchdog.device + ")",
         .ready = writable,
         .seen = writable ? "writable" : std::strerror(errno),
         .step = writable ? ""
                          : "enable the board's watchdog and install its udev rules for the group biteline"});
  }
  return found;
}

}  // namespace

Result<std::vector<DeviceFinding>> check_board(const std::filesystem::path& board_file,
                                               const SourceOptions& options) {
  BITELINE_ASSIGN(hal::Board board, hal::read_board_yaml(board_file));
  std::optional<geometry::SensorModel> head;
  if (options.sensor_file) {
    BITELINE_ASSIGN(head, config::read_sensor_yaml(*options.sensor_file));
  }
  std::vector<DeviceFinding> found = examine(BoardDevices{std::move(board), {}}, head);
  if (!options.set) return found;
  const std::string name = "settings (" + options.set->file + ")";
  constexpr const char* k_step = "mend that line, or take another set (biteline settings)";
  BITELINE_ASSIGN(const std::unique_ptr<SourceKind> kind, choose_source(options));
  const Result<void> tried = kind->try_settings();
  const bool turned = !tried && tried.error().code == Errc::Refused;
  found.push_back(finding(name, tried, turned ? camera_step(tried.error(), false) : k_step));
  if (found.back().ready) found.back().seen = "taken by the camera";
  return found;
}

}  // namespace biteline::sensor
