// SPDX-License-Identifier: MIT
#include "firmware/app/board_source.hpp"

#include <utility>

#include "firmware/app/live_head.hpp"
#include "firmware/runtime/thread_table.hpp"
#include "hal/api/clock.hpp"
#include "hal/board/board.hpp"
#include "hal/linux/ptp/phc.hpp"
#include "hal/linux/pwm/software_pwm.hpp"
#include "hal/linux/pwm/sysfs_pwm.hpp"
#include "hal/linux/rtde/rtde_pose_source.hpp"
#include "hal/linux/thermal/thermal_safety_in.hpp"
#include "hal/linux/watchdog/kernel_watchdog.hpp"
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
#include "hal/linux/socketcan/can_pose_source.hpp"
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
  return hal::ThermalSafetyIn::open(std::move(lines), {.file = laser.temperature, .max_degc = laser.temperature_max_degc});
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

Result<std::unique_ptr<hal::LineCamera>> open_gige([[maybe_unused]] const hal::Board& board, [[maybe_unused]] bool realtime) {
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
  return std::make_unique<hal::CanPoseSource>(std::move(bus), clock, hal::CanPoseSource::Config{.base_id = poses.base_id});
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
    BITELINE_TRY(configure_as_head(*source.camera, model,
                                   board_.camera.hardware_trigger ? hal::Trigger::Hardware : hal::Trigger::FreeRun));
    BITELINE_ASSIGN(source.poses, open_poses());
    BITELINE_ASSIGN(source.trigger, open_trigger());
    if (source.trigger) BITELINE_TRY(source.trigger->configure(train_of(model)));
    if (board_.scan_active) {
      BITELINE_ASSIGN(source.scan_active, open_edges(*board_.scan_active));
    }
    return source;
  }

  Result<std::optional<LaserDevices>> open_laser() override {
    if (!board_.laser) return std::optional<LaserDevices>{};
    LaserDevices devices;
    BITELINE_ASSIGN(devices.laser, open_output(board_.laser->enable));
    BITELINE_ASSIGN(devices.safety, open_safety(*board_.laser));
    BITELINE_TRY(arm_watchdogs(devices.watchdogs));
    if (const std::optional<Nanoseconds>& patience = board_.laser->patience) {
      devices.guard = {.frames_within = *patience, .watchdog_within = *patience, .looks_within = *patience};
    }
    return std::optional<LaserDevices>{std::move(devices)};
  }

 private:
  Result<std::unique_ptr<hal::LineCamera>> open_camera() const {
    BITELINE_ASSIGN(std::unique_ptr<hal::LineCamera> camera, board_.camera.kind == hal::BoardCamera::Kind::V4l2
                                                                 ? open_v4l2(board_.camera)
                                                                 : open_gige(board_, realtime));
    if (!board_.strobe_echo || board_.camera.edge_to_mid_max == Nanoseconds{0}) return camera;
    BITELINE_ASSIGN(std::unique_ptr<hal::EdgeIn> strobe_echo, open_edges(*board_.strobe_echo));
    const hal::TriggerPairing::Config pairing{.latency_min = board_.camera.edge_to_mid_min,
                                              .latency_max = board_.camera.edge_to_mid_max};
    return std::make_unique<hal::TriggeredCamera>(std::move(camera), std::move(strobe_echo),
                                                  hal::TriggeredCamera::Config{.pairing = pairing});
  }

  Result<std::unique_ptr<hal::PoseSource>> open_poses() const {
    if (board_.poses.kind == hal::BoardPoses::Kind::Can) return open_can(board_.poses, clock_);
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
        // Between the safety thread, which nothing may keep from looking, and the poses: an edge has a time of its own.
        return std::make_unique<hal::SoftwarePwm>(
            std::move(line), hal::SoftwarePwm::Config{.priority = runtime::threads::k_pose.priority + 5});
      }
      case hal::BoardTrigger::Kind::None:
        break;
    }
    return std::unique_ptr<hal::PwmOut>{};
  }

  Result<void> arm_watchdogs(std::vector<std::unique_ptr<hal::Watchdog>>& armed) const {
    if (!board_.watchdog.device.empty()) {
      BITELINE_ASSIGN(std::unique_ptr<hal::Watchdog> device, hal::KernelWatchdog::open(board_.watchdog.device));
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

}  // namespace

Result<std::unique_ptr<SourceKind>> open_board(const std::filesystem::path& board_file,
                                               const std::filesystem::path& sensor_file) {
  BITELINE_ASSIGN(hal::Board board, hal::read_board_yaml(board_file));
  BITELINE_ASSIGN(geometry::SensorModel head, read_live_head(sensor_file));
  return std::make_unique<BoardDevices>(std::move(board), std::move(head));
}

}  // namespace biteline::sensor
