// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/places.hpp"

#include <tuple>

namespace biteline::web {

std::optional<Places::Id> Places::who_gives_way(const std::string& address) const {
  std::optional<Id> chosen;
  std::tuple<int, int> best{};  // how many its address has; silent before stranger
  for (const auto& [id, held] : held_) {
    if (held.standing == Standing::Known || (!address.empty() && held.address != address)) continue;
    const std::tuple<int, int> weight{of_address_.at(held.address),
                                      held.standing == Standing::Silent ? 1 : 0};
    if (chosen && weight <= best) continue;
    chosen = id;
    best = weight;
  }
  return chosen;
}

std::optional<Places::Taken> Places::take(const std::string& address, bool local) {
  const auto own = of_address_.find(address);
  const bool address_full = own != of_address_.end() && own->second >= an_address_;
  Taken taken;
  if (address_full || count() >= all_) {
    taken.gives_way = who_gives_way(address_full ? address : std::string{});
    if (taken.gives_way) {
      leave(*taken.gives_way);
    } else if (!local || count() >= all_ + kept_) {
      return std::nullopt;
    }
  }
  taken.id = next_++;
  held_.emplace(taken.id, Held{.address = address});
  ++of_address_[address];
  return taken;
}

void Places::stand(Id id, Standing standing) {
  if (const auto found = held_.find(id); found != held_.end()) found->second.standing = standing;
}

void Places::leave(Id id) {
  const auto found = held_.find(id);
  if (found == held_.end()) return;
  const auto address = of_address_.find(found->second.address);
  if (--address->second == 0) of_address_.erase(address);
  held_.erase(found);
}

}  // namespace biteline::web
