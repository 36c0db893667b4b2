// SPDX-License-Identifier: MIT
#include "hal/linux/pwm/software_pwm.hpp"

#include <pthread.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {
namespace {

void sleep_until(SensorClock::time_point instant) {
  const std::int64_t ns = instant.time_since_epoch().count();
  const std::timespec wake{.tv_sec = ns / 1'000'000'000, .tv_nsec = ns % 1'000'000'000};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, nullptr) == EINTR) {
  }
}

}  // namespace

SoftwarePwm::SoftwarePwm(std::unique_ptr<GpioOut> line, const Config& config)
    : line_{std::move(line)}, config_{config} {}

SoftwarePwm::~SoftwarePwm() {
  static_cast<void>(stop());
}

Result<PwmSettings> SoftwarePwm::configure(const PwmSettings& wanted) {
  // 100 us: below it the two system calls of a pulse are no longer small against the period.
  constexpr Nanoseconds k_period_min{100'000};
  if (wanted.period < k_period_min || wanted.pulse <= Nanoseconds{0} || wanted.pulse >= wanted.period) {
    return fail(Errc::BadValue, "software PWM: period %lld ns, pulse %lld ns",
                static_cast<long long>(wanted.period.count()), static_cast<long long>(wanted.pulse.count()));
  }
  const std::lock_guard lock{mutex_};
  settings_ = wanted;
  changed_ = true;
  return wanted;
}

Result<void> SoftwarePwm::start() {
  if (running()) return {};
  PwmSettings settings;
  {
    const std::lock_guard lock{mutex_};
    if (settings_.period == Nanoseconds{0})
      return fail(Errc::WrongState, "PWM started before it was configured");
    settings = settings_;
    changed_ = false;
    health_ = {};
  }
  stop_wanted_ = false;
  running_ = true;
  thread_ = std::thread{[this, settings] { run(settings); }};
  ::pthread_setname_np(thread_.native_handle(), "soft-pwm");
  if (config_.priority > 0) {
    const sched_param parameters{.sched_priority = config_.priority};
    const int fault = ::pthread_setschedparam(thread_.native_handle(), SCHED_FIFO, &parameters);
    if (fault != 0 && config_.require_real_time) {
      static_cast<void>(stop());
      return device_failure(fault, "software PWM", "SCHED_FIFO");
    }
  }
  return {};
}

Result<void> SoftwarePwm::stop() noexcept {
  stop_wanted_ = true;
  if (thread_.joinable()) thread_.join();
  running_ = false;
  return line_->set(false);
}

PulseHealth SoftwarePwm::pulse_health() const {
  const std::lock_guard lock{mutex_};
  return health_;
}

void SoftwarePwm::run(PwmSettings settings) {
  PulseGrid grid{monotonic_now() + settings.period, settings.period};
  while (!stop_wanted_) {
    sleep_until(grid.next());
    const SensorClock::time_point due = grid.next();
    if (grid.on_wake(monotonic_now())) {
      drive(true);
      sleep_until(due + settings.pulse);
      drive(false);
    }
    const std::lock_guard lock{mutex_};
    health_ = grid.health();
    if (changed_) {
      changed_ = false;
      settings = settings_;
      grid.regrid(due + settings.period, settings.period);
    }
  }
}

void SoftwarePwm::drive(bool active) {
  if (!line_->set(active)) line_faults_.fetch_add(1);
}

}  // namespace biteline::hal
