// SPDX-License-Identifier: MIT
#pragma once
/// \file A cell of ready-made pictures for biteline-sensor (--source board:FILE), with a hand on every wire.
///
/// hal/sim/live renders a shoe; this one only copies, so that the camera's full rate is the camera's, and it
/// can be made to fail: each fault is one that the fault table in tests/integration/faults names.

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/profile/profile.hpp"
#include "hal/sim/bus/bus_server.hpp"
#include "hal/sim/gvcamera/gv_camera.hpp"
#include "hal/sim/gvcamera/lossy_line.hpp"
#include "hal/sim/live/cell_faults.hpp"
#include "hal/sim/live/trigger_timer.hpp"

namespace biteline::test {

struct PictureCellConfig {
  int width_px{640}, height_px{120};  ///< region, of a sensor of 1626 x 1236 pixels
  double rate_hz{100};
  double pose_rate_hz{250};
  double lost_packet_ratio{0};  ///< by the camera, which cannot send them again
  double lossy_line_ratio{0};   ///< by a line before the camera, which can
  /// Different ones, then again from the first.  A prime, so that no loss of a round number hides.
  std::uint32_t pictures{13};
  geometry::CameraState calibrated{};  ///< what sensor.yaml tells of the camera
  /// CANopen node of an encoder, which is the pose then; 0: none.
  std::uint8_t encoder_node{0};
};

/// What a test may do to the running cell.  Any thread.
struct PictureCellFaults : sim::CellFaults {
  std::atomic<bool> robot_needs_light{false};  ///< its scan line falls as soon as the laser's does
};

/// Threads: camera, wires, trigger and poses, real-time ones where this process may: no compiler beside it
/// holds hardware up.  Public methods from any.
class PictureCell {
 public:
  [[nodiscard]] static Result<std::unique_ptr<PictureCell>> open(const PictureCellConfig& config);
  ~PictureCell();
  PictureCell(const PictureCell&) = delete;
  PictureCell& operator=(const PictureCell&) = delete;

  [[nodiscard]] const geometry::SensorModel& head() const { return head_; }
  /// For --source board:FILE and --sensor.
  [[nodiscard]] std::string board_file_text() const;
  [[nodiscard]] std::string sensor_file_text() const;

  PictureCellFaults faults;
  void unplug_camera();
  /// Of the camera, as another program would: a register of hal/sim/gvcamera, and no more by this sensor.
  void leave_in_camera(std::uint32_t address, std::uint32_t value);
  void lock_camera_state();
  void plug_camera();
  void set_door(bool closed) { bus_->drive(sim::Line::Interlock, closed, now()); }
  void set_scan_active(bool active) { bus_->drive(sim::Line::ScanActive, active, now()); }
  void set_too_hot(bool hot) { bus_->drive(sim::Line::TooHot, hot, now()); }

  [[nodiscard]] bool laser_on() const { return bus_->level(sim::Line::LaserEnable); }
  /// The last time that the laser's line fell.
  [[nodiscard]] SensorClock::time_point dark_since() const {
    return SensorClock::time_point{Nanoseconds{dark_since_ns_}};
  }
  /// Edges that came while the camera was busy, as on a real one: no frame, and none lost.
  [[nodiscard]] std::uint64_t triggers_missed() const { return camera_->triggers_missed(); }

  /// Round a circle at 250 mm/s.
  [[nodiscard]] SE3 T_base_flange_at(SensorClock::time_point instant) const;
  static constexpr double k_speed_mm_s = 250;
  static constexpr double k_radius_mm = 100;
  /// Of the encoder, which turns evenly.
  static constexpr double k_ticks_per_s = 47'321;

  /// The stripe's row in picture `number` (taken modulo their count), in the region.
  [[nodiscard]] double stripe_row_px(std::uint64_t number, int column) const;
  [[nodiscard]] std::span<const std::uint8_t> picture(std::uint64_t number) const {
    return pictures_[number % config_.pictures];
  }
  /// What the firmware's pipeline makes of each picture, without any device.
  [[nodiscard]] std::vector<std::vector<profile::ProfilePoint>> expected_profiles() const;
  /// Which picture these points are of; nothing when they are of none.
  [[nodiscard]] std::optional<std::size_t> picture_of(std::span<const profile::ProfilePoint> points) const;

 private:
  explicit PictureCell(const PictureCellConfig& config);
  [[nodiscard]] static SensorClock::time_point now();
  Result<void> open_camera();
  void paint(const sim::GvExposure& exposure, std::span<std::uint8_t> pixels) const;
  void on_edge(SensorClock::time_point edge, Nanoseconds pulse);
  void fire(SensorClock::time_point edge, Nanoseconds pulse);
  void send_poses(const std::stop_token& stop);
  void send_encoder(SensorClock::time_point instant);

  PictureCellConfig config_;
  geometry::SensorModel head_;
  std::string name_;
  SensorClock::time_point start_;
  std::vector<std::vector<std::uint8_t>> pictures_;
  std::atomic<std::int64_t> dark_since_ns_{0};
  std::mutex camera_mutex_;
  std::unique_ptr<sim::BusServer> bus_;
  std::unique_ptr<sim::GvCamera> camera_;
  std::unique_ptr<sim::LossyLine> line_;
  std::unique_ptr<sim::TriggerTimer> trigger_;
  std::jthread poses_;
};

}  // namespace biteline::test
