// SPDX-License-Identifier: MIT
#pragma once
/// \file A recorded session's pictures as a camera.

#include <memory>

#include "common/session/session.hpp"
#include "hal/api/line_camera.hpp"

namespace biteline::hal::replay {

struct ReplayCameraConfig {
  int buffers{16};        ///< pictures decoded ahead, or lent, at any time
  int decode_threads{2};  ///< a picture takes about as long to decode as to process
};

/// Gives every picture in order, as fast as they can be decoded; never skips one.  A picture that cannot be
/// read ends the recording: next_frame() gives that Error from then on. configure() takes only what was
/// recorded: region, exposure and rate are the session's.
class ReplayCamera final : public LineCamera {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ReplayCamera>> open(
      std::shared_ptr<const session::Session> session, const ReplayCameraConfig& config);
  ~ReplayCamera() override;

  [[nodiscard]] Result<CameraLimits> limits() override;
  /// As it was recorded.
  [[nodiscard]] Result<geometry::CameraState> state() override;
  [[nodiscard]] Result<CameraSettings> configure(const CameraSettings& wanted) override;
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<FrameView> next_frame(Nanoseconds timeout) override;
  void release(const FrameView& frame) noexcept override;
  [[nodiscard]] Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] CameraHealth health() const noexcept override;

 private:
  struct State;
  explicit ReplayCamera(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::hal::replay
