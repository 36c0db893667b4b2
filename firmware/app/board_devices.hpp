// SPDX-License-Identifier: MIT
#pragma once
/// \file The devices that a board.yaml names, opened for scans and for a check.

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/app/live_head.hpp"
#include "firmware/app/source.hpp"
#include "hal/api/clock.hpp"
#include "hal/board/board.hpp"

namespace biteline::sensor {

class BoardDevices final : public SourceKind {
 public:
  BoardDevices(hal::Board board, geometry::SensorModel head);

  [[nodiscard]] Result<Source> open() override;
  [[nodiscard]] Result<std::optional<LaserDevices>> open_laser() override;
  [[nodiscard]] Result<void> try_settings() override;
  [[nodiscard]] Result<void> expect_lit_rate() const override;
  [[nodiscard]] Result<void> adopt(const geometry::SensorModel& head, const Capture& exposed,
                                   const settings::SettingsSet& wanted) override;
  [[nodiscard]] Result<void> learn_limits() override;

  /// A head whose settings are put back when the camera does not take others.
  void remember(const geometry::SensorModel& head);

  [[nodiscard]] const hal::Board& board() const { return board_; }
  /// Tied to the edges of its strobe echo where the board says how they lie.
  [[nodiscard]] Result<std::unique_ptr<hal::LineCamera>> open_camera() const;
  [[nodiscard]] Result<std::unique_ptr<hal::PoseSource>> open_poses() const;
  /// Null where the camera runs by itself.
  [[nodiscard]] Result<std::unique_ptr<hal::PwmOut>> open_trigger() const;

 private:
  [[nodiscard]] Result<void> configure(hal::LineCamera& camera, LiveSettings wanted);
  void take_limits(const Result<hal::CameraLimits>& told);
  [[nodiscard]] LiveSettings present_settings() const;
  [[nodiscard]] hal::Trigger trigger() const {
    return board_.camera.hardware_trigger ? hal::Trigger::Hardware : hal::Trigger::FreeRun;
  }
  [[nodiscard]] Result<void> arm_watchdogs(std::vector<std::unique_ptr<hal::Watchdog>>& armed) const;

  hal::Board board_;
  std::optional<hal::CameraSettings> former_;  ///< what the camera took last
  std::optional<double> own_gain_;             ///< the camera's, from before a set told it another one
  hal::MonotonicClock clock_;
};

/// Errc::NotSupported where the board has what this program was built without.
[[nodiscard]] Result<std::unique_ptr<SourceKind>> open_board(const std::filesystem::path& board_file,
                                                             const std::filesystem::path& sensor_file,
                                                             const std::optional<settings::SettingsSet>& set);

}  // namespace biteline::sensor
