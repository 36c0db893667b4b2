// SPDX-License-Identifier: MIT
#include "hal/linux/pwm/encoder_trigger.hpp"

#include <pthread.h>

#include "hal/linux/posix/descriptor.hpp"
#include "hal/linux/pwm/pitch_grid.hpp"

namespace biteline::hal {
namespace {

constexpr std::chrono::microseconds k_look{500};

}  // namespace

Result<std::unique_ptr<EncoderTrigger>> EncoderTrigger::open(std::unique_ptr<EncoderIn> encoder,
                                                             std::unique_ptr<GpioOut> line,
                                                             const Config& config) {
  if (config.pitch_ticks <= 0) {
    return fail(Errc::BadValue, "encoder trigger: pitch of %lld ticks",
                static_cast<long long>(config.pitch_ticks));
  }
  return std::unique_ptr<EncoderTrigger>{new EncoderTrigger{std::move(encoder), std::move(line), config}};
}

EncoderTrigger::~EncoderTrigger() {
  static_cast<void>(stop());
}

Result<PwmSettings> EncoderTrigger::configure(const PwmSettings& wanted) {
  if (wanted.period <= Nanoseconds{0} || wanted.pulse <= Nanoseconds{0} || wanted.pulse >= wanted.period) {
    return fail(Errc::BadValue, "encoder trigger: period %lld ns, pulse %lld ns",
                static_cast<long long>(wanted.period.count()), static_cast<long long>(wanted.pulse.count()));
  }
  period_ns_ = wanted.period.count();
  pulse_ns_ = wanted.pulse.count();
  return wanted;
}

Result<void> EncoderTrigger::start() {
  if (running()) return {};
  if (period_ns_ == 0) return fail(Errc::WrongState, "encoder trigger started before it was configured");
  pulses_ = missed_ = read_failures_ = line_faults_ = 0;
  stop_wanted_ = false;
  running_ = true;
  thread_ = std::thread{[this] { run(); }};
  ::pthread_setname_np(thread_.native_handle(), "enc-trigger");
  const sched_param parameters{.sched_priority = config_.priority};
  if (config_.priority > 0)
    static_cast<void>(::pthread_setschedparam(thread_.native_handle(), SCHED_FIFO, &parameters));
  return {};
}

Result<void> EncoderTrigger::stop() noexcept {
  stop_wanted_ = true;
  if (thread_.joinable()) thread_.join();
  running_ = false;
  return line_->set(false);
}

void EncoderTrigger::run() {
  PitchGrid grid{config_.pitch_ticks};
  SensorClock::time_point free_at = monotonic_now();
  bool heard = false;
  while (!stop_wanted_) {
    if (const Result<EncoderReading> reading = encoder_->read()) {
      heard = true;
      std::int64_t pitches = grid.on_position(reading->position_ticks);
      const SensorClock::time_point now = monotonic_now();
      if (pitches > 0 && now >= free_at) {
        free_at = now + Nanoseconds{period_ns_};
        pulse();
        --pitches;
      }
      missed_.fetch_add(static_cast<std::uint64_t>(pitches));
    } else if (heard) {
      read_failures_.fetch_add(1);
    }
    std::this_thread::sleep_for(k_look);
  }
}

void EncoderTrigger::pulse() {
  if (!line_->set(true)) line_faults_.fetch_add(1);
  std::this_thread::sleep_for(Nanoseconds{pulse_ns_});
  if (!line_->set(false)) line_faults_.fetch_add(1);
  pulses_.fetch_add(1);
}

}  // namespace biteline::hal
