// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/next_of.hpp"

#include <utility>

namespace biteline::service {

NextStep next_of(const NextFacts& facts) {
  if (!facts.sends) return {};
  if (facts.waits) return {.next = Next::Hold, .keeps_recording = true};
  if (!facts.has_path) return {};
  if (facts.confirmed) return {.next = Next::Send};
  const bool must_be_seen = facts.drift_stops || !facts.looks.empty() || facts.asked_to_hold;
  const bool asks = must_be_seen || facts.asks_by_gate;
  if (asks && facts.doors) return {.next = Next::Hold, .keeps_recording = true};
  if (!must_be_seen) return {.next = Next::Send, .keeps_recording = asks || !facts.seen};
  const auto refuse = [](std::string why) {
    return NextStep{.next = Next::Refuse, .keeps_recording = true, .why = std::move(why)};
  };
  if (facts.drift_stops) return refuse("the calibration has drifted, or could not be checked");
  if (!facts.looks.empty()) return refuse(facts.looks);
  // Of a service before this one, that had doors.
  return refuse("every scan waits for a person, and no door is open (a start without hold ends that)");
}

}  // namespace biteline::service
