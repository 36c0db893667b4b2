// SPDX-License-Identifier: MIT
#include "hal/linux/ptp/phc.hpp"

#include <fcntl.h>
#include <linux/ptp_clock.h>

#include <cerrno>
#include <ctime>

namespace biteline::hal {
namespace {

/// clock_gettime(2), "Dynamic clocks": FD_TO_CLOCKID.
clockid_t clock_of(int descriptor) {
  return static_cast<clockid_t>((~static_cast<unsigned>(descriptor) << 3U) | 3U);
}

constexpr int k_readings =
    10;  // a preemption inside one of them is near certain on a busy unit, inside all ten is not

}  // namespace

Result<Phc> Phc::open(const std::string& path) {
  BITELINE_ASSIGN(Descriptor device, open_device(path.c_str(), O_RDONLY));
  ptp_clock_caps capabilities{};
  if (retrying_ioctl(device.number(), PTP_CLOCK_GETCAPS, &capabilities) < 0) {
    return device_failure(errno, path.c_str(), "is no PTP clock");
  }
  return Phc{std::move(device), path};
}

Result<ReferenceClock::Reading> Phc::measure() const {
  Reading best{.offset = {}, .uncertainty = Nanoseconds::max(), .at = {}};
  for (int i = 0; i < k_readings; ++i) {
    std::timespec hardware{};
    const SensorClock::time_point before = monotonic_now();
    if (::clock_gettime(clock_of(device_.number()), &hardware) < 0) {
      return device_failure(errno, path_.c_str(), "read clock");
    }
    const SensorClock::time_point after = monotonic_now();
    const Nanoseconds half_window = (after - before + Nanoseconds{1}) / 2;
    if (half_window >= best.uncertainty) continue;
    const Nanoseconds hardware_time{std::int64_t{hardware.tv_sec} * 1'000'000'000 + hardware.tv_nsec};
    best = {.offset = hardware_time - (before + half_window).time_since_epoch(),
            .uncertainty = half_window,
            .at = before + half_window};
  }
  return best;
}

}  // namespace biteline::hal
