// SPDX-License-Identifier: MIT
// What the stream thread tells of itself: counts, stages, devices and health, also of the scan that was.
#include "firmware/app/streamer.hpp"

namespace biteline::sensor {
namespace {

wire::ClockState clock_state(const char* name, const hal::ClockHealth& clock) {
  return {.name = name,
          .known = clock.known,
          .offset = clock.offset,
          .uncertainty = clock.uncertainty,
          .drift_ppm = clock.drift_ppm,
          .steps = clock.steps};
}

wire::StageTime stage_time(const char* name, const runtime::StageMeter& meter) {
  const runtime::StageMeter::Summary summary = meter.summary();
  return {.name = name, .count = summary.count, .min = summary.min, .mean = summary.mean, .max = summary.max};
}

}  // namespace

wire::Counters Streamer::counters() const {
  return scanner_ ? scanner_->counts() : last_end_.counters;
}

std::vector<wire::StageTime> Streamer::stages() const {
  if (!scanner_) return last_end_.stages;
  return {stage_time("wait_for_frame", scanner_->wait_meter),
          stage_time("frame_to_profile", scanner_->process_meter),
          stage_time("adjust_camera", scanner_->adjust_meter),
          stage_time("copy_picture", scanner_->picture_meter),
          stage_time("stamp_pose", scanner_->stamp_meter),
          stage_time("encode", encode_meter_)};
}

wire::Devices Streamer::devices() const {
  wire::Devices devices = scanner_ ? wire::Devices{} : last_end_.devices;
  devices.realtime = config_.realtime == runtime::RealtimeDemand::Required;
  if (laser_ != nullptr) devices.watchdog_feeds_failed = laser_->status().feeds_failed;
  if (!scanner_) return devices;
  const Source& source = scanner_->source();
  const hal::CameraHealth camera = source.camera->health();
  const hal::PoseHealth poses = source.poses->health();
  devices.clocks = {clock_state("camera", camera.clock), clock_state("poses", poses.clock)};
  if (camera.trigger.watched) devices.trigger.emplace(camera.trigger);
  devices.trigger_by_software = source.trigger != nullptr && !source.trigger->hardware_timed();
  devices.camera_connected = camera.connected;
  devices.camera_underruns = camera.underruns;
  devices.packets_resent = camera.packets_resent;
  if (kind_.capture.any()) devices.capture = scanner_->capture_state();
  if (camera.temperature_known) {
    devices.temperature_degc = camera.temperature_degc;
    head_degc_ = static_cast<double>(camera.temperature_degc);
  }
  devices.poses_flow = poses.state == hal::PoseState::Streaming;
  devices.pose_reconnects = poses.reconnects;
  devices.poses_unlatched = poses.poses_unlatched;
  devices.bus_errors = poses.bus_errors;
  devices.bus_restarts = poses.bus_restarts;
  return devices;
}

wire::Health Streamer::health() const {
  wire::Health health;
  health.counters = counters();
  health.stages = stages();
  health.scanning = state_ != State::Idle;
  health.devices = devices();
  health.pictures = picture_maker_.made();
  if (!kind_.recording) health.settings = settings_.state();
  // Nothing while its writer is held up in the middle: what was told before stands.
  if (const std::optional<wire::UpkeepState> upkeep = upkeep_.rt_load()) upkeep_told_ = upkeep;
  health.upkeep = upkeep_told_;
  frames_ = frames_before_ + (scanner_ ? health.counters.frames : 0);
  if (laser_ == nullptr) {
    health.laser_reason = "there is no laser";
    return health;
  }
  const runtime::LaserWatch::Status laser = laser_->status();
  health.laser = laser.on ? wire::LaserState::On
                 : laser.state == runtime::LaserGuard::State::Latched || laser.output_lost
                     ? wire::LaserState::Fault
                     : wire::LaserState::Off;
  if (!laser.on) health.laser_reason = runtime::text(laser.reason);
  if (!laser.on && test_pattern_ && state_ == State::Scanning)
    health.laser_reason += "; the sensor shows its test pattern";
  return health;
}

}  // namespace biteline::sensor
