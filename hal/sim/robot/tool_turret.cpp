// SPDX-License-Identifier: MIT
#include "hal/sim/robot/tool_turret.hpp"

#include <algorithm>

namespace biteline::sim {

std::uint64_t ToolTurret::step(double time_s, std::uint64_t outputs) {
  const auto is_on = [outputs](const TurretFacts::Place& place) {
    return (outputs >> static_cast<unsigned>(place.ask_output) & 1U) != 0;
  };
  const auto& places = facts_.places;
  if (std::ranges::count_if(places, is_on) == 1) {
    const auto asked = static_cast<std::size_t>(std::ranges::find_if(places, is_on) - places.begin());
    if (asked != asked_) {
      asked_ = asked;
      begin_s_ = time_s;
      turns_ = true;
    }
  }
  if (turns_ && !facts_.stuck && time_s - begin_s_ >= facts_.turn_s) {
    turns_ = false;
    facts_.stands = asked_;
  }
  return turns_ ? 0 : std::uint64_t{1} << static_cast<unsigned>(places[facts_.stands].there_input);
}

}  // namespace biteline::sim
