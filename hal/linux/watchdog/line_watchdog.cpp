// SPDX-License-Identifier: MIT
#include "hal/linux/watchdog/line_watchdog.hpp"

namespace biteline::hal {

Result<Nanoseconds> LineWatchdog::arm(Nanoseconds timeout) {
  if (timeout <= Nanoseconds{0}) return fail(Errc::BadValue, "watchdog timeout");
  armed_ = true;
  BITELINE_TRY(feed());
  return timeout;
}

Result<void> LineWatchdog::feed() noexcept {
  if (!armed_) return fail(Errc::WrongState, "watchdog fed before it was armed");
  level_ = !level_;
  return line_->set(level_);
}

Result<void> LineWatchdog::disarm() {
  armed_ = level_ = false;
  return line_->set(false);
}

}  // namespace biteline::hal
