// SPDX-License-Identifier: MIT
#pragma once
/// \file A made picture in place of each of the camera's: what comes of it is known.

#include <memory>
#include <optional>
#include <vector>

#include "common/geometry/sensor_model.hpp"
#include "hal/api/line_camera.hpp"

namespace biteline::sensor {

/// Middle of the pattern's stripe in a column of the region, row of the full sensor: one period of a sine
/// across the region, an eighth of its height to either side of the middle.
[[nodiscard]] double pattern_row_px(const geometry::Region& region, int column_px);

/// A LineCamera round another one: frames come when its frames come, with their stamps, numbers and faults,
/// but show the pattern.  Each is flagged k_frame_damaged, so that no host takes its points for a surface.
///
/// Errc::DeviceError: a frame that does not show the whole region; never the camera's own picture.
/// RT: as the other camera.  Memory: one picture, made in the constructor.
class TestPatternCamera final : public hal::LineCamera {
 public:
  TestPatternCamera(std::unique_ptr<hal::LineCamera> camera, const geometry::Region& region);

  [[nodiscard]] Result<hal::CameraLimits> limits() override { return camera_->limits(); }
  [[nodiscard]] Result<double> rate_max_hz() override { return camera_->rate_max_hz(); }
  [[nodiscard]] Result<geometry::CameraState> set_state(const geometry::CameraState& wanted) override {
    return camera_->set_state(wanted);
  }
  [[nodiscard]] Result<geometry::CameraState> state() override { return camera_->state(); }
  [[nodiscard]] Result<hal::CameraSettings> configure(const hal::CameraSettings& wanted) override {
    return camera_->configure(wanted);
  }
  [[nodiscard]] Result<void> start() override { return camera_->start(); }
  [[nodiscard]] Result<hal::FrameView> next_frame(Nanoseconds timeout) override;
  void release(const hal::FrameView& frame) noexcept override;
  [[nodiscard]] Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override {
    return camera_->adjust_exposure(exposure);
  }
  [[nodiscard]] Result<void> stop() override { return camera_->stop(); }
  [[nodiscard]] hal::CameraHealth health() const noexcept override { return camera_->health(); }

 private:
  std::unique_ptr<hal::LineCamera> camera_;
  geometry::Region region_;
  std::vector<std::uint8_t> pixels_;
  hal::FrameView lent_;  ///< as the camera lent it
};

}  // namespace biteline::sensor
