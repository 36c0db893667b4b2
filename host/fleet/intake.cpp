// SPDX-License-Identifier: MIT
#include "host/fleet/intake.hpp"

#include <algorithm>
#include <utility>

namespace biteline::fleet {
namespace {

/// For so long a cell counts as too quick after it was.
constexpr std::chrono::seconds k_held_lives{15};

}  // namespace

void Intake::put(FromCell shoe, Clock::time_point now) {
  if (!cells_.contains(shoe.cell) && cells_.size() >= k_most_cells_heard) return;
  OfCell& of = cells_.try_emplace(shoe.cell, OfCell{.filled = now}).first->second;
  const double passed_s = std::chrono::duration<double>(now - of.filled).count();
  of.may = std::min(k_rows_at_once, of.may + std::max(0.0, passed_s) * k_rows_a_minute / 60);
  of.filled = now;
  if (of.may < 1 || of.shoes.size() >= k_most_waiting_of_one) {
    of.held = of.held || of.may < 1;
    if (of.may < 1) of.held_at = now;
    return;
  }
  of.may -= 1;
  of.shoes.push_back(std::move(shoe));
  ++waiting_;
}

std::vector<FromCell> Intake::take(std::size_t most) {
  std::vector<FromCell> taken;
  auto at = cells_.upper_bound(turn_);
  while (taken.size() < most && waiting_ > 0) {
    if (at == cells_.end()) at = cells_.begin();
    if (!at->second.shoes.empty()) {
      taken.push_back(std::move(at->second.shoes.front()));
      at->second.shoes.pop_front();
      --waiting_;
      turn_ = at->first;
    }
    ++at;
  }
  return taken;
}

std::string Intake::held_words(const std::string& cell, Clock::time_point now) const {
  const auto found = cells_.find(cell);
  if (found == cells_.end() || !found->second.held || now - found->second.held_at > k_held_lives) return {};
  return "more than " + std::to_string(static_cast<int>(k_rows_a_minute)) +
         " shoes a minute: the rest is taken later";
}

void Intake::clear() {
  for (auto& [name, of] : cells_) of.shoes.clear();
  waiting_ = 0;
}

}  // namespace biteline::fleet
