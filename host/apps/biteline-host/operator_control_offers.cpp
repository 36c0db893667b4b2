// SPDX-License-Identifier: MIT
// What the cell takes now: a command that is not offered is answered 409, so a page shows no button for it.
#include "host/apps/biteline-host/operator_control.hpp"

namespace biteline::service {

api::Json OperatorControl::offers_locked() const {
  const bool held = cell_.shoe() == Shoe::Held;
  const bool mends = held && mending_ == shoe_scan_;
  const bool one_at_a_time = cycle_.on_demand() && cycle_.busy();
  const bool goes_on = cell_.goes_on();
  const std::string working = working_locked();
  const bool sendable = held && !mends && !not_sendable_locked();
  const bool plans = held && !mends && config_.rerun_arm;
  api::Json offers = api::Json::array();
  const auto offer = [&offers](const char* command, bool taken) {
    if (taken) offers.push_back(command);
  };
  offer("start", !held && !goes_on && !one_at_a_time);
  offer("rescan", !cell_.arm_will_move() && !goes_on && (held ? !mends : !one_at_a_time));
  offer("accept", sendable);
  offer("reject", held && !mends);
  offer("hold", !working.empty() && past_hold_ != working && hold_wanted_ != working);
  offer("model", held && waits_ == Waits::ForModel);
  offer("process", plans);
  // The gate is the same: what it would refuse moves in the air as little.
  offer("air", plans && sendable && waits_ == Waits::ForWord);
  offer("look", plans && waits_ == Waits::ForWord && cell_.sensing() == Sensing::Idle);
  offer("mend", held && waits_ != Waits::ForModel && mending_.empty());
  return offers;
}

}  // namespace biteline::service
