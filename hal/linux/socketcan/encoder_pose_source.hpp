// SPDX-License-Identifier: MIT
#pragma once
/// \file An encoder's way as the head's pose: a conveyor or a turntable under the shoe instead of an arm.

#include <atomic>
#include <memory>

#include "hal/api/clock.hpp"
#include "hal/api/encoder_in.hpp"
#include "hal/api/pose_source.hpp"

namespace biteline::hal {

/// The shoe moves and the head stands; told as the head's motion round the shoe, so that everything after it
/// is as with an arm: T_base_flange = exp(position * twist per tick) * T at the start, `base` travelling with
/// the shoe. A position older than `lost_after` is no pose: the encoder is silent.
class EncoderPoseSource final : public PoseSource {
 public:
  struct Config {
    Twist per_tick{Twist::Zero()};  ///< in base: [mm; rad] per tick
    SE3 T_base_flange_start{SE3::Identity()};
    Nanoseconds lost_after{100'000'000};
  };
  EncoderPoseSource(std::unique_ptr<EncoderIn> encoder, const Clock& clock, const Config& config)
      : encoder_{std::move(encoder)}, clock_{clock}, config_{config} {}

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<RobotPose> next_pose(Nanoseconds timeout) override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] PoseHealth health() const noexcept override;

 private:
  std::unique_ptr<EncoderIn> encoder_;
  const Clock& clock_;
  Config config_;
  SensorClock::time_point last_stamp_;
  std::atomic<PoseState> state_{PoseState::Idle};
  std::atomic<std::uint64_t> poses_{0}, rejected_{0}, reconnects_{0};
};

}  // namespace biteline::hal
