// SPDX-License-Identifier: MIT
#include "firmware/app/board_devices.hpp"

#include "common/config/sensor_yaml.hpp"
#include "firmware/app/backends/backend.hpp"
#include "firmware/app/test_pattern.hpp"
#include "firmware/runtime/thread_table.hpp"
#include "hal/linux/pwm/encoder_trigger.hpp"
#include "hal/linux/pwm/software_pwm.hpp"
#include "hal/linux/watchdog/kernel_watchdog.hpp"
#include "hal/linux/watchdog/line_watchdog.hpp"
#include "hal/linux/watchdog/systemd_watchdog.hpp"
#include "hal/timing/triggered_camera.hpp"

namespace biteline::sensor {

BoardDevices::BoardDevices(hal::Board board, geometry::SensorModel head) : board_{std::move(board)} {
  model = std::move(head);
  simulated = board_.simulated;
  by_way = board_.trigger.kind == hal::BoardTrigger::Kind::Encoder;
}

Result<Source> BoardDevices::open() {
  Source source;
  source.scan_name = board_.name;
  BITELINE_ASSIGN(source.camera, open_camera());
  BITELINE_TRY(configure(*source.camera, present_settings()));
  in_use = set_in_use(*former_, model, capture);
  if (capture.test_pattern)
    source.camera = std::make_unique<TestPatternCamera>(std::move(source.camera), model.region);
  BITELINE_ASSIGN(source.poses, open_poses());
  BITELINE_ASSIGN(source.trigger, open_trigger());
  if (source.trigger) BITELINE_TRY(source.trigger->configure(train_of(model, capture)));
  if (board_.scan_active) {
    BITELINE_ASSIGN(source.scan_active, open_edges(*board_.scan_active));
  }
  return source;
}

LiveSettings BoardDevices::present_settings() const {
  return live_settings(model, capture, trigger(), set);
}

Result<void> BoardDevices::configure(hal::LineCamera& camera, LiveSettings wanted) {
  // Before all else: sizes and regions are counted in what it makes of the picture.
  BITELINE_ASSIGN(camera_state, camera.set_state(model.camera_state));
  BITELINE_TRY(geometry::expect_state(model.camera_state, camera_state));
  // A camera keeps a gain that was told: a set that says none gets the one from before the first that did.
  if (wanted.camera.gain && !own_gain_) {
    BITELINE_ASSIGN(const hal::CameraLimits before, camera.limits());
    own_gain_ = before.gain;
  }
  if (!wanted.camera.gain) wanted.camera.gain = own_gain_;
  BITELINE_ASSIGN(const hal::CameraSettings taken, configure_camera(camera, wanted, former_));
  // Of the region and exposure that it now has; a camera that does not tell is no worse a camera.
  take_limits(camera.limits());
  former_ = taken;
  // Sizes are chosen by then.
  BITELINE_ASSIGN(camera_state, camera.state());
  BITELINE_TRY(geometry::expect_state(model.camera_state, camera_state));
  return {};
}

void BoardDevices::take_limits(const Result<hal::CameraLimits>& told) {
  limits = told.value_or(hal::CameraLimits{});
  limits_known = told.has_value();
}

Result<void> BoardDevices::learn_limits() {
  if (limits_known) return {};
  BITELINE_ASSIGN(const std::unique_ptr<hal::LineCamera> camera, open_camera());
  take_limits(camera->limits());
  return {};
}

void BoardDevices::remember(const geometry::SensorModel& head) {
  former_ = live_settings(head, {}, trigger(), std::nullopt).camera;
}

Result<void> BoardDevices::adopt(const geometry::SensorModel& head, const Capture& exposed,
                                 const settings::SettingsSet& wanted) {
  BITELINE_TRY(check_lit_rate(live_settings(head, exposed, trigger(), wanted), board_));
  BITELINE_ASSIGN(const std::unique_ptr<hal::LineCamera> camera, open_camera());
  // What the trigger does not take the next scan would refuse.
  BITELINE_ASSIGN(const std::unique_ptr<hal::PwmOut> pulses, open_trigger());
  if (pulses) {
    if (const auto train = pulses->configure(train_of(head, exposed)); !train) {
      const std::string words{train.error().where.view()};
      return fail(train.error().code, "camera.rate_hz, exposure_us or second_exposure_us: %s", words.c_str());
    }
  }
  BITELINE_TRY(configure(*camera, live_settings(head, exposed, trigger(), wanted)));
  model = head;
  capture = exposed;
  set = wanted;
  in_use = set_in_use(*former_, model, capture);
  return {};
}

Result<void> BoardDevices::try_settings() {
  BITELINE_ASSIGN(const std::unique_ptr<hal::LineCamera> camera, open_camera());
  BITELINE_ASSIGN(const hal::CameraLimits before, camera->limits());
  BITELINE_TRY(configure(*camera, present_settings()));
  if (!former_->gain || !before.gain) return {};
  // A camera keeps its gain when it is closed, and this is only a trial.
  hal::CameraSettings back = *former_;
  back.gain = before.gain;
  BITELINE_TRY(camera->configure(back));
  return {};
}

Result<void> BoardDevices::expect_lit_rate() const {
  return check_lit_rate(present_settings(), board_);
}

Result<std::optional<LaserDevices>> BoardDevices::open_laser() {
  if (!board_.laser) return std::optional<LaserDevices>{};
  LaserDevices devices;
  BITELINE_ASSIGN(devices.laser, open_output(board_.laser->enable));
  BITELINE_ASSIGN(devices.safety, open_safety(*board_.laser));
  BITELINE_TRY(arm_watchdogs(devices.watchdogs));
  devices.guard = guard_of(*board_.laser);
  return std::optional<LaserDevices>{std::move(devices)};
}

Result<std::unique_ptr<hal::LineCamera>> BoardDevices::open_camera() const {
  BITELINE_ASSIGN(std::unique_ptr<hal::LineCamera> camera, sensor::open_camera(board_, realtime));
  if (!board_.strobe_echo || board_.camera.edge_to_mid_max == Nanoseconds{0}) return camera;
  BITELINE_ASSIGN(std::unique_ptr<hal::EdgeIn> strobe_echo, open_edges(*board_.strobe_echo));
  const hal::TriggerPairing::Config pairing{.latency_min = board_.camera.edge_to_mid_min,
                                            .latency_max = board_.camera.edge_to_mid_max};
  return std::make_unique<hal::TriggeredCamera>(
      std::move(camera), std::move(strobe_echo),
      hal::TriggeredCamera::Config{.pairing = pairing,
                                   .even_train = board_.trigger.kind != hal::BoardTrigger::Kind::Encoder});
}

Result<std::unique_ptr<hal::PoseSource>> BoardDevices::open_poses() const {
  return sensor::open_poses(board_.poses, clock_);
}

Result<std::unique_ptr<hal::PwmOut>> BoardDevices::open_trigger() const {
  switch (board_.trigger.kind) {
    case hal::BoardTrigger::Kind::HardwareTimer:
      return open_timer(board_.trigger);
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

Result<void> BoardDevices::arm_watchdogs(std::vector<std::unique_ptr<hal::Watchdog>>& armed) const {
  if (board_.laser->heartbeat) {
    BITELINE_ASSIGN(std::unique_ptr<hal::GpioOut> line, open_output(*board_.laser->heartbeat));
    armed.push_back(std::make_unique<hal::LineWatchdog>(std::move(line)));
    BITELINE_TRY(armed.back()->arm(board_.watchdog.timeout));
  }
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

Result<std::unique_ptr<SourceKind>> open_board(const std::filesystem::path& board_file,
                                               const std::filesystem::path& sensor_file,
                                               const std::optional<settings::SettingsSet>& set) {
  BITELINE_ASSIGN(hal::Board board, hal::read_board_yaml(board_file));
  BITELINE_ASSIGN(const geometry::SensorModel calibrated, config::read_sensor_yaml(sensor_file));
  BITELINE_ASSIGN(geometry::SensorModel head, with_set(calibrated, set, sensor_file));
  auto devices = std::make_unique<BoardDevices>(std::move(board), std::move(head));
  devices->set = set;
  devices->calibrated = calibrated;
  devices->head_file = sensor_file;
  // What it would run with without the set: put back when the camera does not take it.
  if (const auto bare = with_set(calibrated, std::nullopt, sensor_file); set && bare)
    devices->remember(*bare);
  return devices;
}

}  // namespace biteline::sensor
