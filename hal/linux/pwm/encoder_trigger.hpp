// SPDX-License-Identifier: MIT
#pragma once
/// \file The camera's trigger by way instead of time: a pulse for each pitch of an encoder.

#include <atomic>
#include <memory>
#include <thread>

#include "hal/api/encoder_in.hpp"
#include "hal/api/gpio_out.hpp"
#include "hal/api/pwm_out.hpp"

namespace biteline::hal {

struct EncoderTriggerHealth {
  std::uint64_t pulses{0};
  std::uint64_t pitches_missed{
      0};  ///< reached within one object of the encoder, or before the camera was ready again
  std::uint64_t read_failures{0};  ///< of the encoder, after its first position
  std::uint64_t line_faults{0};
};

/// A SCHED_FIFO thread reads the encoder twice a millisecond, twice as often as one sends, and toggles a
/// line.  The pulse follows its pitch by up to the encoder's own period, so exposures are tied to the strobe
/// echo and to the path coordinate (EncoderPoseSource), never to the pitch itself. As a PwmOut: `period` is
/// the shortest between two pulses, which is what the camera can follow.
class EncoderTrigger final : public PwmOut {
 public:
  struct Config {
    std::int64_t pitch_ticks{0};
    int priority{0};  ///< SCHED_FIFO; 0, or without the rights: the scheduler of the caller
  };
  /// Errc::BadValue: no pitch.
  [[nodiscard]] static Result<std::unique_ptr<EncoderTrigger>> open(std::unique_ptr<EncoderIn> encoder,
                                                                    std::unique_ptr<GpioOut> line,
                                                                    const Config& config);
  ~EncoderTrigger() override;

  [[nodiscard]] Result<PwmSettings> configure(const PwmSettings& wanted) override;
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<void> stop() noexcept override;
  [[nodiscard]] bool running() const noexcept override { return running_.load(); }
  [[nodiscard]] bool hardware_timed() const noexcept override { return false; }

  [[nodiscard]] EncoderTriggerHealth trigger_health() const {
    return {.pulses = pulses_,
            .pitches_missed = missed_,
            .read_failures = read_failures_,
            .line_faults = line_faults_};
  }

 private:
  EncoderTrigger(std::unique_ptr<EncoderIn> encoder, std::unique_ptr<GpioOut> line, const Config& config)
      : encoder_{std::move(encoder)}, line_{std::move(line)}, config_{config} {}
  void run();
  void pulse();

  std::unique_ptr<EncoderIn> encoder_;
  std::unique_ptr<GpioOut> line_;
  Config config_;
  std::atomic<std::int64_t> period_ns_{0}, pulse_ns_{0};
  std::atomic<bool> running_{false}, stop_wanted_{false};
  std::atomic<std::uint64_t> pulses_{0}, missed_{0}, read_failures_{0}, line_faults_{0};
  std::thread thread_;
};

}  // namespace biteline::hal
