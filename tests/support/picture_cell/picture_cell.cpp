// SPDX-License-Identifier: MIT
#include "tests/support/picture_cell/picture_cell.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "common/canpose/encoder.hpp"
#include "common/canpose/pose_frames.hpp"
#include "common/config/sensor_yaml.hpp"
#include "firmware/pipeline/profile_pipeline.hpp"
#include "hal/sim/bus/board_file.hpp"
#include "hal/sim/live/urgency.hpp"

namespace biteline::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// A pose's FD frame follows its SYNC by about its own length on the wire.
constexpr Nanoseconds k_frame_time = microseconds{250};
/// The port is fixed by the standard: until whoever had it has given it back.
constexpr int k_port_attempts = 150;

/// Its turns are as short as the wires'.
constexpr int k_poses_priority = 88;

geometry::SensorModel head_of(const PictureCellConfig& config) {
  geometry::SensorModel head;
  head.camera = {.fu_px = 1800, .fv_px = 1800, .cu_px = 813, .cv_px = 618};
  head.laser_plane = {.normal_cam = Vec3{0, std::sqrt(0.5), std::sqrt(0.5)}, .distance_mm = 150};
  head.region = {.offset_u_px = (1626 - config.width_px) / 2,
                 .offset_v_px = (1236 - config.height_px) / 2,
                 .width_px = config.width_px,
                 .height_px = config.height_px};
  head.rate_hz = config.rate_hz;
  head.exposure = microseconds{500};
  return head;
}

}  // namespace

PictureCell::PictureCell(const PictureCellConfig& config)
    : config_{config},
      head_{head_of(config)},
      name_{"biteline-picture-cell-" + std::to_string(getpid())},
      start_{now()} {
  const int width_px = config.width_px, height_px = config.height_px;
  for (std::uint32_t number = 0; number < config.pictures; ++number) {
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px),
                                     10);
    for (int u = 0; u < width_px; ++u) {
      const double centre_px = stripe_row_px(number, u);
      for (int v = static_cast<int>(centre_px) - 7; v <= static_cast<int>(centre_px) + 8; ++v) {
        const double distance = (v - centre_px) / 2.0;
        pixels[static_cast<std::size_t>(v * width_px + u)] =
            static_cast<std::uint8_t>(10 + std::lround(180 * std::exp(-0.5 * distance * distance)));
      }
    }
    pictures_.push_back(std::move(pixels));
  }
}

PictureCell::~PictureCell() {
  // They call into each other: the wires hear nobody any more, then the callers end, then what they called.
  if (bus_) bus_->close();
  poses_ = {};
  trigger_.reset();
  camera_.reset();
}

SensorClock::time_point PictureCell::now() {
  return hal::monotonic_now();
}

double PictureCell::stripe_row_px(std::uint64_t number, int column) const {
  const double ripple_px = 0.1 * config_.height_px;
  return 0.4 * config_.height_px + 0.5 * static_cast<double>(number % config_.pictures) +
         ripple_px * std::sin(column * 0.01);
}

Result<std::unique_ptr<PictureCell>> PictureCell::open(const PictureCellConfig& config) {
  std::unique_ptr<PictureCell> cell{new PictureCell{config}};
  PictureCell* const self = cell.get();
  {
    const sim::Urgently urgently{sim::k_trigger_priority};
    cell->trigger_ = std::make_unique<sim::TriggerTimer>(
        [self](SensorClock::time_point edge, Nanoseconds pulse) { self->on_edge(edge, pulse); });
  }
  sim::BusServer::Callbacks callbacks;
  callbacks.on_line = [self](sim::Line line, bool active, SensorClock::time_point stamp) {
    if (line == sim::Line::LaserEnable && !active) self->dark_since_ns_ = stamp.time_since_epoch().count();
  };
  callbacks.on_trigger = [self](Nanoseconds period, Nanoseconds pulse) {
    self->trigger_->configure(period, pulse);
  };
  {
    const sim::Urgently urgently{sim::k_wires_priority};
    BITELINE_ASSIGN(cell->bus_, sim::BusServer::open(cell->name_, std::move(callbacks)));
  }
  BITELINE_TRY(cell->open_camera());
  if (config.lossy_line_ratio > 0) {
    const sim::Urgently urgently{sim::k_camera_priority};
    BITELINE_ASSIGN(cell->line_, sim::LossyLine::open({.lost_ratio = config.lossy_line_ratio}));
  }
  cell->bus_->drive(sim::Line::Interlock, true, now());
  cell->bus_->drive(sim::Line::Key, true, now());
  const sim::Urgently urgently{k_poses_priority};
  cell->poses_ = std::jthread{[self](const std::stop_token& stop) { self->send_poses(stop); }};
  return cell;
}

Result<void> PictureCell::open_camera() {
  const sim::Urgently urgently{sim::k_camera_priority};
  sim::GvCamera::Config camera;
  camera.region = head_.region;
  camera.exposure = *head_.exposure;
  camera.rate_hz = config_.rate_hz;
  camera.lost_packet_ratio = config_.lost_packet_ratio;
  camera.resends = config_.lossy_line_ratio > 0;
  for (int attempt = 1;; ++attempt) {
    auto opened = sim::GvCamera::open(
        camera,
        [this](const sim::GvExposure& exposure, std::span<std::uint8_t> pixels) { paint(exposure, pixels); });
    if (opened) {
      const std::lock_guard lock{camera_mutex_};
      camera_ = std::move(*opened);
      return {};
    }
    if (attempt == k_port_attempts) return tl::unexpected<Error>{opened.error()};
    std::this_thread::sleep_for(milliseconds{100});
  }
}

void PictureCell::unplug_camera() {
  std::unique_ptr<sim::GvCamera> gone;
  const std::lock_guard lock{camera_mutex_};
  gone = std::move(camera_);
}

void PictureCell::leave_in_camera(std::uint32_t address, std::uint32_t value) {
  const std::lock_guard lock{camera_mutex_};
  camera_->leave(address, value);
}

void PictureCell::lock_camera_state() {
  const std::lock_guard lock{camera_mutex_};
  camera_->lock_state();
}

void PictureCell::plug_camera() {
  if (!open_camera()) std::abort();  // the port was this process's own a moment ago
}

std::string PictureCell::board_file_text() const {
  std::string text = sim::board_yaml_text({.wires = name_, .camera = line_ ? "127.0.0.2" : "127.0.0.1"});
  if (config_.encoder_node == 0) return text;
  const std::string bus = "  kind: can\n  interface: sim:" + name_;
  return text.replace(text.find(bus), bus.size(),
                      "  kind: encoder\n  interface: sim:" + name_ +
                          "\n  node: " + std::to_string(config_.encoder_node) +
                          "\n  per_tick_mm: [0.005, 0, 0]\n  per_tick_rad: [0, 0, 0]");
}

std::string PictureCell::sensor_file_text() const {
  geometry::SensorModel told = head_;
  told.camera_state = config_.calibrated;
  return config::sensor_yaml_text(told, "made for a test");
}

void PictureCell::paint(const sim::GvExposure& exposure, std::span<std::uint8_t> pixels) const {
  const std::span<const std::uint8_t> source = picture(exposure.sequence);
  if (pixels.size() == source.size()) std::memcpy(pixels.data(), source.data(), pixels.size());
}

void PictureCell::on_edge(SensorClock::time_point edge, Nanoseconds pulse) {
  if (sim::due(faults.edges_to_lose)) return;
  fire(edge, pulse);
  if (sim::due(faults.edges_to_double)) fire(edge + microseconds{800}, Nanoseconds{0});
}

void PictureCell::fire(SensorClock::time_point edge, Nanoseconds pulse) {
  if (!sim::due(faults.echoes_to_lose)) {
    bus_->drive(sim::Line::StrobeEcho, true, edge);
    bus_->drive(sim::Line::StrobeEcho, false, edge + pulse);
  }
  if (faults.camera_silent) return;
  const std::lock_guard lock{camera_mutex_};
  if (camera_) camera_->trigger(edge);
}

SE3 PictureCell::T_base_flange_at(SensorClock::time_point instant) const {
  const double angle_rad =
      k_speed_mm_s / k_radius_mm * std::chrono::duration<double>(instant - start_).count();
  SE3 T = SE3::Identity();
  T.linear() = Eigen::AngleAxisd{angle_rad, Vec3::UnitZ()}.toRotationMatrix();
  T.translation() = k_radius_mm * Vec3{std::cos(angle_rad), std::sin(angle_rad), 0};
  return T;
}

void PictureCell::send_encoder(SensorClock::time_point instant) {
  const double way_ticks = k_ticks_per_s * 1e-9 * static_cast<double>((instant - start_).count());
  const auto position = static_cast<std::uint32_t>(std::llround(way_ticks));
  hal::CanFrame frame{.id = canpose::tpdo1_id(config_.encoder_node), .size_bytes = 4, .received = instant};
  for (std::size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<std::uint8_t>(position >> (8 * i));
  bus_->send(frame);
}

void PictureCell::send_poses(const std::stop_token& stop) {
  constexpr Nanoseconds k_hour = std::chrono::hours{1};
  // A controller without hardware stamps: its interrupt comes when it comes.
  constexpr std::uint32_t k_stamp_late_max_ns = 10'000;
  std::mt19937 random{7};
  const Nanoseconds period{std::llround(1e9 / config_.pose_rate_hz)};
  std::uint8_t counter = 0;
  for (SensorClock::time_point due = now(); !stop.stop_requested(); due += period) {
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point{due.time_since_epoch()});
    if (faults.robot_needs_light && !laser_on()) set_scan_active(false);
    counter = static_cast<std::uint8_t>(counter % canpose::k_sync_counter_last + 1);
    if (faults.bus_off) continue;
    if (config_.encoder_node != 0) send_encoder(due);
    // The instant is the grid's and not this thread's: a real controller's SYNC does not wait for our
    // scheduler.
    const bool ahead = sim::due(faults.poses_from_future);
    hal::CanFrame sync{
        .id = canpose::k_sync_id,
        .size_bytes = 1,
        .received = due + Nanoseconds{random() % k_stamp_late_max_ns} + (ahead ? k_hour : Nanoseconds{0})};
    sync.data[0] = counter;
    if (!faults.sync_stopped) bus_->send(sync);
    if (faults.poses_silent) continue;
    const Nanoseconds stamp = (due - start_) + Nanoseconds{faults.robot_clock_step_ns} + k_hour;
    const auto coded = canpose::encode_fd({.sync_counter = counter,
                                           .status = canpose::k_simulated,
                                           .stamp_us = static_cast<std::uint64_t>(stamp.count() / 1000),
                                           .T_base_flange = T_base_flange_at(due)});
    hal::CanFrame pose{.id = canpose::k_default_base_id + canpose::k_fd_id_offset,
                       .fd = true,
                       .bit_rate_switch = true,
                       .size_bytes = canpose::k_fd_size_bytes,
                       .received = due + k_frame_time};
    std::copy(coded->begin(), coded->end(), pose.data.begin());
    bus_->send(pose);
  }
}

std::vector<std::vector<profile::ProfilePoint>> PictureCell::expected_profiles() const {
  auto pipeline = pipeline::ProfilePipeline::create({}, head_);
  auto buffer = std::make_unique<profile::ProfileBuffer>();
  std::vector<std::vector<profile::ProfilePoint>> profiles;
  for (std::uint32_t number = 0; number < config_.pictures; ++number) {
    hal::FrameView frame;
    frame.pixels = picture(number);
    frame.width_px = config_.width_px;
    frame.height_px = config_.height_px;
    frame.stride_bytes = static_cast<std::size_t>(config_.width_px);
    frame.sequence = number;
    if (!pipeline || !pipeline->rt_process(frame, *buffer)) return {};
    profiles.emplace_back(buffer->view().begin(), buffer->view().end());
  }
  return profiles;
}

std::optional<std::size_t> PictureCell::picture_of(std::span<const profile::ProfilePoint> points) const {
  if (points.empty()) return std::nullopt;
  const profile::ProfilePoint& middle = points[points.size() / 2];
  const double above_first_px = middle.row_px - head_.region.offset_v_px - stripe_row_px(0, middle.column);
  const auto number = std::lround(2 * above_first_px);
  if (number < 0 || number >= static_cast<long>(config_.pictures)) return std::nullopt;
  return static_cast<std::size_t>(number);
}

}  // namespace biteline::test
