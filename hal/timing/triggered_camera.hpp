// SPDX-License-Identifier: MIT
#pragma once
/// \file A camera whose exposures are timed by the edges of its strobe echo, whatever its own stamps are
/// worth.

#include <memory>

#include "common/rt/latest_value.hpp"
#include "hal/api/edge_in.hpp"
#include "hal/api/line_camera.hpp"
#include "hal/timing/edge_grid.hpp"
#include "hal/timing/trigger_pairing.hpp"

namespace biteline::hal {

/// A LineCamera round another one.  A frame that pairs with one rising edge gets its mid-exposure from it and
/// loses the flag of an uncertain stamp; one that pairs with none or two keeps its own stamp and is flagged
/// k_frame_trigger_mismatch. A strobe line that fails costs the pairing, never the frames.
class TriggeredCamera final : public LineCamera {
 public:
  struct Config {
    TriggerPairing::Config pairing;  ///< edge to mid-exposure as the camera tells it
    bool even_train{true};           ///< false: an encoder's pulses, which no grid of time fits
  };
  TriggeredCamera(std::unique_ptr<LineCamera> camera, std::unique_ptr<EdgeIn> strobe_echo,
                  const Config& config)
      : camera_{std::move(camera)}, strobe_echo_{std::move(strobe_echo)}, config_{config} {}

  [[nodiscard]] Result<CameraLimits> limits() override { return camera_->limits(); }
  [[nodiscard]] Result<double> rate_max_hz() override { return camera_->rate_max_hz(); }
  [[nodiscard]] Result<geometry::CameraState> set_state(const geometry::CameraState& wanted) override {
    return camera_->set_state(wanted);
  }
  [[nodiscard]] Result<geometry::CameraState> state() override { return camera_->state(); }
  [[nodiscard]] Result<CameraSettings> configure(const CameraSettings& wanted) override;
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<FrameView> next_frame(Nanoseconds timeout) override;
  void release(const FrameView& frame) noexcept override { camera_->release(frame); }
  [[nodiscard]] Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override;
  [[nodiscard]] Result<RowRange> adjust_rows(const RowRange& rows) override {
    return camera_->adjust_rows(rows);
  }
  [[nodiscard]] Result<void> stop() override { return camera_->stop(); }
  [[nodiscard]] CameraHealth health() const noexcept override;

 private:
  /// Edges have their places in time.
  [[nodiscard]] bool on_grid() const { return settings_.rate_hz > 0 && config_.even_train; }
  void take_edges();
  void publish();

  std::unique_ptr<LineCamera> camera_;
  std::unique_ptr<EdgeIn> strobe_echo_;
  Config config_;
  CameraSettings settings_;
  TriggerPairing pairing_{config_.pairing};
  EdgeGrid grid_{{.period = Nanoseconds{1}, .tolerance = Nanoseconds{0}}};
  rt::LatestValue<TriggerHealth> published_;
};

}  // namespace biteline::hal
