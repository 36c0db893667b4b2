// SPDX-License-Identifier: MIT
#include "firmware/app/board_source.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <thread>
#include <utility>

#include "firmware/app/live_head.hpp"
#include "firmware/runtime/realtime.hpp"
#include "firmware/runtime/thread_table.hpp"
#include "hal/api/clock.hpp"
#include "hal/board/board.hpp"
#include "hal/linux/posix/descriptor.hpp"
#include "hal/linux/ptp/phc.hpp"
#include "hal/linux/pwm/encoder_trigger.hpp"
#include "hal/linux/pwm/software_pwm.hpp"
#include "hal/linux/pwm/sysfs_pwm.hpp"
#include "hal/linux/rtde/rtde_pose_source.hpp"
#include "hal/linux/thermal/thermal_safety_in.hpp"
#include "hal/linux/watchdog/kernel_watchdog.hpp"
#include "hal/linux/watchdog/line_watchdog.hpp"
#include "hal/linux/watchdog/systemd_watchdog.hpp"
#include "hal/timing/triggered_camera.hpp"
#ifdef BITELINE_WITH_ARAVIS
#include "hal/linux/aravis/aravis_camera.hpp"
#endif
#ifdef BITELINE_WITH_GPIOD
#include "hal/linux/gpiod/gpiod_edge_in.hpp"
#include "hal/linux/gpiod/gpiod_out.hpp"
#include "hal/linux/gpiod/gpiod_safety_in.hpp"
#endif
#ifdef BITELINE_WITH_SOCKETCAN
#include "hal/linux/socketcan/can_encoder.hpp"
#include "hal/linux/socketcan/can_pose_source.hpp"
#include "hal/linux/socketcan/encoder_pose_source.hpp"
#include "hal/linux/socketcan/socketcan_bus.hpp"
#endif
#ifdef BITELINE_WITH_V4L2
#include "hal/linux/v4l2/v4l2_camera.hpp"
#endif

namespace biteline::sensor {
namespace {

[[maybe_unused]] tl::unexpected<Error> built_without(const char* what) {
  return fail(Errc::NotSupported, "this biteline-sensor was built without %s", what);
}

Result<std::unique_ptr<hal::GpioOut>> open_output([[maybe_unused]] const hal::GpioLineAddress& line) {
#ifdef BITELINE_WITH_GPIOD
  return hal::GpiodOut::open(line);
#else
  return built_without("GPIO");
#endif
}

Result<std::unique_ptr<hal::EdgeIn>> open_edges([[maybe_unused]] const hal::GpioLineAddress& line) {
#ifdef BITELINE_WITH_GPIOD
  return hal::GpiodEdgeIn::open(line);
#else
  return built_without("GPIO");
#endif
}

Result<std::unique_ptr<hal::SafetyIn>> open_safety([[maybe_unused]] const hal::BoardLaser& laser) {
#ifdef BITELINE_WITH_GPIOD
  BITELINE_ASSIGN(std::unique_ptr<hal::SafetyIn> lines,
                  hal::GpiodSafetyIn::open({.interlock = laser.interlock, .key = laser.key}));
  if (laser.temperature.empty()) return lines;
  return hal::ThermalSafetyIn::open(std::move(lines),
                                    {.file = laser.temperature, .max_degc = laser.temperature_max_degc});
#else
  return built_without("GPIO");
#endif
}

Result<std::unique_ptr<hal::LineCamera>> open_v4l2([[maybe_unused]] const hal::BoardCamera& camera) {
#ifdef BITELINE_WITH_V4L2
  return hal::V4l2Camera::open({.device = camera.device,
                                .control_device = camera.control_device,
                                .gain = camera.gain,
                                .readout = camera.readout,
                                .hardware_trigger = camera.hardware_trigger});
#else
  return built_without("V4L2");
#endif
}

Result<std::unique_ptr<hal::LineCamera>> open_gige([[maybe_unused]] const hal::Board& board,
                                                   [[maybe_unused]] bool realtime) {
#ifdef BITELINE_WITH_ARAVIS
  hal::AravisCamera::Config config;
  config.address = board.camera.address;
  config.packet_bytes = board.camera.packet_bytes;
  config.packet_socket = board.camera.packet_socket;
  config.receive_priority = realtime ? runtime::threads::k_receive.priority : 0;
  if (!board.ptp.empty()) {
    BITELINE_ASSIGN(hal::Phc clock, hal::Phc::open(board.ptp));
    BITELINE_TRY(clock.measure());
    config.ptp_clock = std::make_shared<hal::Phc>(std::move(clock));
  }
  return hal::AravisCamera::open(config);
#else
  return built_without("Aravis");
#endif
}

Result<std::unique_ptr<hal::PoseSource>> open_can([[maybe_unused]] const hal::BoardPoses& poses,
                                                  [[maybe_unused]] const hal::Clock& clock) {
#ifdef BITELINE_WITH_SOCKETCAN
  BITELINE_ASSIGN(std::unique_ptr<hal::CanBus> bus, hal::SocketcanBus::open({.interface = poses.interface}));
  return std::make_unique<hal::CanPoseSource>(std::move(bus), clock,
                                              hal::CanPoseSource::Config{.base_id = poses.base_id});
#else
  return built_without("SocketCAN");
#endif
}

Result<std::unique_ptr<hal::EncoderIn>> open_encoder([[maybe_unused]] const hal::BoardEncoder& encoder) {
#ifdef BITELINE_WITH_SOCKETCAN
  BITELINE_ASSIGN(std::unique_ptr<hal::CanBus> bus,
                  hal::SocketcanBus::open({.interface = encoder.interface}));
  return hal::CanEncoder::open(std::move(bus), {.node = encoder.node, .range_ticks = encoder.range_ticks});
#else
  return built_without("SocketCAN");
#endif
}

Result<std::unique_ptr<hal::PoseSource>> open_encoder_poses([[maybe_unused]] const hal::BoardPoses& poses,
                                                            [[maybe_unused]] const hal::Clock& clock) {
#ifdef BITELINE_WITH_SOCKETCAN
  BITELINE_ASSIGN(std::unique_ptr<hal::EncoderIn> encoder, open_encoder(poses.encoder));
  return std::make_unique<hal::EncoderPoseSource>(std::move(encoder), clock,
                                                  hal::EncoderPoseSource::Config{.per_tick = poses.per_tick});
#else
  return built_without("SocketCAN");
#endif
}

class BoardDevices final : public SourceKind {
 public:
  BoardDevices(hal::Board board, geometry::SensorModel head) : board_{std::move(board)} {
    model = std::move(head);
    simulated = board_.simulated;
  }

  Result<Source> open() override {
    Source source;
    source.scan_name = board_.name;
    BITELINE_ASSIGN(source.camera, open_camera());
    BITELINE_TRY(
        configure_as_head(*source.camera, model, capture,
                          board_.camera.hardware_trigger ? hal::Trigger::Hardware : hal::Trigger::FreeRun));
    BITELINE_ASSIGN(source.poses, open_poses());
    BITELINE_ASSIGN(source.trigger, open_trigger());
    if (source.trigger) BITELINE_TRY(source.trigger->configure(train_of(model, capture)));
    if (board_.scan_active) {
      BITELINE_ASSIGN(source.scan_active, open_edges(*board_.scan_active));
    }
    return source;
  }

  /// One row for each device that the board names; see check_board().
  std::vector<DeviceFinding> examine() const;

  Result<std::optional<LaserDevices>> open_laser() override {
    if (!board_.laser) return std::optional<LaserDevices>{};
    LaserDevices devices;
    BITELINE_ASSIGN(devices.laser, open_output(board_.laser->enable));
    BITELINE_ASSIGN(devices.safety, open_safety(*board_.laser));
    BITELINE_TRY(arm_watchdogs(devices.watchdogs));
    if (const std::optional<Nanoseconds>& patience = board_.laser->patience) {
      devices.guard = {.frames_within = *patience,
                       .watchdog_within = *patience,
                       .stream_within = *patience,
                       .looks_within = *patience};
    }
    return std::optional<LaserDevices>{std::move(devices)};
  }

 private:
  Result<std::unique_ptr<hal::LineCamera>> open_camera() const {
    BITELINE_ASSIGN(std::unique_ptr<hal::LineCamera> camera,
                    board_.camera.kind == hal::BoardCamera::Kind::V4l2 ? open_v4l2(board_.camera)
                                                                       : open_gige(board_, realtime));
    if (!board_.strobe_echo || board_.camera.edge_to_mid_max == Nanoseconds{0}) return camera;
    BITELINE_ASSIGN(std::unique_ptr<hal::EdgeIn> strobe_echo, open_edges(*board_.strobe_echo));
    const hal::TriggerPairing::Config pairing{.latency_min = board_.camera.edge_to_mid_min,
                                              .latency_max = board_.camera.edge_to_mid_max};
    return std::make_unique<hal::TriggeredCamera>(
        std::move(camera), std::move(strobe_echo),
        hal::TriggeredCamera::Config{.pairing = pairing,
                                     .even_train = board_.trigger.kind != hal::BoardTrigger::Kind::Encoder});
  }

  Result<std::unique_ptr<hal::PoseSource>> open_poses() const {
    if (board_.poses.kind == hal::BoardPoses::Kind::Can) return open_can(board_.poses, clock_);
    if (board_.poses.kind == hal::BoardPoses::Kind::Encoder) return open_encoder_poses(board_.poses, clock_);
    hal::RtdePoseSource::Config config;
    config.controller = {.address = board_.poses.address, .port = board_.poses.port};
    config.samples.rate_hz = board_.poses.rate_hz;
    return hal::RtdePoseSource::open(config);
  }

  Result<std::unique_ptr<hal::PwmOut>> open_trigger() const {
    switch (board_.trigger.kind) {
      case hal::BoardTrigger::Kind::HardwareTimer:
        return hal::SysfsPwm::open({.chip = board_.trigger.chip, .channel = board_.trigger.channel});
      case hal::BoardTrigger::Kind::Software: {
        BITELINE_ASSIGN(std::unique_ptr<hal::GpioOut> line, open_output(board_.trigger.line));
        // Between the safety thread, which nothing may keep from looking, and the poses: an edge has a time
        // of its own.
        return std::make_unique<hal::SoftwarePwm>(
            std::move(line), hal::SoftwarePwm::Config{.priority = runtime::threads::k_pose.priority + 5});
      }
      case hal::BoardTrigger::Kind::Encoder: {
        BITELINE_ASSIGN(std::unique_ptr<hal::EncoderIn> encoder, open_encoder(board_.trigger.encoder));
        BITELINE_ASSIGN(std::unique_ptr<hal::GpioOut> line, open_output(board_.trigger.line));
        return hal::EncoderTrigger::open(std::move(encoder), std::move(line),
                                         {.pitch_ticks = board_.trigger.pitch_ticks,
                                          .priority = realtime ? runtime::threads::k_pose.priority + 5 : 0});
      }
      case hal::BoardTrigger::Kind::None:
        break;
    }
    return std::unique_ptr<hal::PwmOut>{};
  }

  Result<void> arm_watchdogs(std::vector<std::unique_ptr<hal::Watchdog>>& armed) const {
    if (board_.laser->heartbeat) {
      BITELINE_ASSIGN(std::unique_ptr<hal::GpioOut> line, open_output(*board_.laser->heartbeat));
      armed.push_back(std::make_unique<hal::LineWatchdog>(std::move(line)));
      BITELINE_TRY(armed.back()->arm(board_.watchdog.timeout));
    }
    if (!board_.watchdog.device.empty()) {
      BITELINE_ASSIGN(std::unique_ptr<hal::Watchdog> device,
                      hal::KernelWatchdog::open(board_.watchdog.device));
      BITELINE_TRY(device->arm(board_.watchdog.timeout));
      armed.push_back(std::move(device));
    }
    if (!board_.watchdog.systemd) return {};
    Result<std::unique_ptr<hal::SystemdWatchdog>> systemd = hal::SystemdWatchdog::open_from_environment();
    // Started by hand: there is nobody to tell.
    if (!systemd && systemd.error().code == Errc::DeviceNotFound) return {};
    if (!systemd) return tl::unexpected<Error>{systemd.error()};
    BITELINE_TRY((*systemd)->arm(board_.watchdog.timeout));
    armed.push_back(std::move(*systemd));
    return {};
  }

  hal::Board board_;
  hal::MonotonicClock clock_;
};

template <class T>
DeviceFinding finding(std::string what, const Result<T>& opened, const char* step) {
  if (opened) return {.what = std::move(what), .ready = true, .seen = "answers", .step = {}};
  return {.what = std::move(what), .ready = false, .seen = to_line(opened.error()), .step = step};
}

std::string name_of(const char* what, const hal::GpioLineAddress& line) {
  return std::string{what} + " (" + line.chip + " " + line.line + ")";
}

Result<hal::PoseSample> first_pose(Result<std::unique_ptr<hal::PoseSource>> poses) {
  constexpr Nanoseconds k_patience = std::chrono::seconds{1};
  if (!poses) return tl::unexpected<Error>{poses.error()};
  BITELINE_TRY((*poses)->start());
  return (*poses)->next_pose(k_patience);
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

std::vector<DeviceFinding> BoardDevices::examine() const {
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
  const bool is_gige = board_.camera.kind == hal::BoardCamera::Kind::GigE;
  found.push_back(finding(
      "camera (" + (is_gige ? board_.camera.address : board_.camera.device) + ")", open_camera(),
      is_gige
          ? "check the camera's cable, power and address, and that its port has an address in the same net"
          : "load the board's overlay and check the camera's cable; join the group video"));
  if (board_.trigger.kind != hal::BoardTrigger::Kind::None) {
    found.push_back(finding("trigger (" + board_.trigger.chip + board_.trigger.line.chip + ")",
                            open_trigger(),
                            "load the board's overlay and install its udev rules for the group biteline"));
  }
  if (board_.laser) {
    found.push_back(finding(name_of("laser enable", board_.laser->enable), open_output(board_.laser->enable),
                            k_line_step));
    if (board_.laser->heartbeat) {
      found.push_back(finding(name_of("heartbeat", *board_.laser->heartbeat),
                              open_output(*board_.laser->heartbeat), k_line_step));
    }
    found.push_back(
        finding(name_of("interlock", board_.laser->interlock), open_safety(*board_.laser), k_line_step));
  }
  if (board_.strobe_echo && board_.camera.edge_to_mid_max == Nanoseconds{0}) {
    found.push_back(
        finding(name_of("strobe echo", *board_.strobe_echo), open_edges(*board_.strobe_echo), k_line_step));
  }
  if (board_.scan_active) {
    found.push_back(
        finding(name_of("scan active", *board_.scan_active), open_edges(*board_.scan_active), k_line_step));
  }
  const bool is_can = board_.poses.kind != hal::BoardPoses::Kind::Rtde;
  const std::string& interface =
      board_.poses.kind == hal::BoardPoses::Kind::Encoder ? board_.poses.encoder.interface : board_.poses.interface;
  const std::string can_step =
      "ip link set " + interface +
      " up type can bitrate 500000 dbitrate 2000000 fd on restart-ms 100, and start what sends on it";
  found.push_back(
      finding("poses (" + (is_can ? interface : board_.poses.address) + ")", first_pose(open_poses()),
              is_can ? can_step.c_str()
                     : "switch the controller on, check the cable, and allow RTDE in its settings"));
  if (!board_.ptp.empty()) {
    const Result<hal::Phc> clock = hal::Phc::open(board_.ptp);
    found.push_back(
        finding("PTP clock (" + board_.ptp + ")",
                clock ? clock->measure().map([](const auto&) {}) : tl::unexpected<Error>{clock.error()},
                "enable the network port's hardware clock and start ptp4l on it"));
  }
  if (!board_.watchdog.device.empty()) {
    const bool writable = ::access(board_.watchdog.device.c_str(), W_OK) == 0;
    found.push_back(
        {.what = "watchdog (" + board_.watchdog.device + ")",
         .ready = writable,
         .seen = writable ? "writable" : std::strerror(errno),
         .step = writable ? ""
                          : "enable the board's watchdog and install its udev rules for the group biteline"});
  }
  return found;
}

}  // namespace

Result<std::vector<DeviceFinding>> check_board(const std::filesystem::path& board_file) {
  BITELINE_ASSIGN(hal::Board board, hal::read_board_yaml(board_file));
  return BoardDevices{std::move(board), {}}.examine();
}

Result<std::unique_ptr<SourceKind>> open_board(const std::filesystem::path& board_file,
                                               const std::filesystem::path& sensor_file) {
  BITELINE_ASSIGN(hal::Board board, hal::read_board_yaml(board_file));
  BITELINE_ASSIGN(geometry::SensorModel head, read_live_head(sensor_file));
  return std::make_unique<BoardDevices>(std::move(board), std::move(head));
}

}  // namespace biteline::sensor
