// SPDX-License-Identifier: MIT
// What the cell takes now: a command that is not offered is answered 409, so a page shows no button for it.
#include "host/apps/biteline-host/cockpit.hpp"

namespace biteline::service {

api::Json Cockpit::offers_locked() const {
  const bool held = !held_.empty();
  const bool mends = held && mending_ == held_;
  const bool one_at_a_time = cycle_.on_demand() && cycle_.busy();
  const bool coming = phase_ == Phase::Scanning || phase_ == Phase::Working;
  const bool sendable = held && !mends && !not_sendable_locked();
  const bool plans = held && !mends && config_.rerun_arm;
  api::Json offers = api::Json::array();
  const auto offer = [&offers](const char* command, bool taken) {
    if (taken) offers.push_back(command);
  };
  offer("start", !held && going_on_.empty() && !one_at_a_time);
  offer("rescan", phase_ != Phase::Following && going_on_.empty() && (held ? !mends : !one_at_a_time));
  offer("accept", sendable);
  offer("reject", held && !mends);
  offer("hold", !held && coming && !scan_.empty() && past_hold_ != scan_ && hold_wanted_ != scan_);
  offer("model", held && wait_ == Wait::Model);
  offer("process", plans);
  // The gate is the same: what it would refuse moves in the air as little.
  offer("air", plans && sendable && wait_ == Wait::Word);
  offer("mend", held && wait_ != Wait::Model && mending_.empty());
  return offers;
}

}  // namespace biteline::service
