// SPDX-License-Identifier: MIT
#include "firmware/stream/observers.hpp"

#include <algorithm>

namespace biteline::stream {
namespace {

Nanoseconds period_of(double rate_hz) {
  return Nanoseconds{static_cast<std::int64_t>(1e9 / rate_hz)};
}

}  // namespace

Observers::Welcome Observers::on_hello(const PeerId& peer, const wire::ObserverHello& hello,
                                       SensorClock::time_point now) {
  const auto known = observers_.find(peer);
  if (known == observers_.end()) {
    if (observers_.size() >= config_.max_observers) return Welcome::NoPlace;
    observers_[peer] = {
        .hello = hello, .heard = now, .profile_due = now, .sent = hello.received, .taken = hello.received};
    ++wishes_version_;
    return Welcome::New;
  }
  Observer& observer = known->second;
  if (!(observer.hello.picture == hello.picture)) ++wishes_version_;
  observer.hello = hello;
  observer.heard = now;
  // What was never sent cannot have been taken.
  observer.taken = std::clamp(hello.received, observer.taken, observer.sent);
  return Welcome::Known;
}

void Observers::erase(const PeerId& peer) {
  if (observers_.erase(peer) > 0) ++wishes_version_;
  newest_sent_.erase(peer);
}

void Observers::drop_silent(SensorClock::time_point now) {
  std::vector<PeerId> silent;
  for (const auto& [peer, observer] : observers_) {
    if (now - observer.heard > config_.forgotten_after) silent.push_back(peer);
  }
  for (const PeerId& peer : silent) erase(peer);
}

void Observers::tell(std::span<const std::uint8_t> packet) {
  for (const auto& [peer, observer] : observers_) outbox_.send(peer, packet);
}

bool Observers::ready(const Observer& observer) const {
  return observer.sent - observer.taken < config_.window;
}

void Observers::offer_profile(std::uint64_t sequence, std::span<const std::uint8_t> packet,
                              SensorClock::time_point now) {
  for (auto& [peer, observer] : observers_) {
    if (observer.hello.profile_rate_hz <= 0 || now < observer.profile_due || !ready(observer)) continue;
    const auto sent = newest_sent_.find(peer);
    if (sent != newest_sent_.end() && sent->second == sequence) continue;
    if (!outbox_.send(peer, packet)) continue;
    newest_sent_[peer] = sequence;
    observer.profile_due = now + period_of(observer.hello.profile_rate_hz);
    ++observer.sent;
  }
}

void Observers::offer_picture(const MadePicture& picture) {
  for (auto& [peer, observer] : observers_) {
    if (!(observer.hello.picture == picture.wish) || !ready(observer)) continue;
    if (outbox_.send(peer, picture.packet)) ++observer.sent;
  }
}

std::vector<wire::PictureWish> Observers::picture_wishes() const {
  std::vector<wire::PictureWish> wishes;
  for (const auto& [peer, observer] : observers_) {
    const wire::PictureWish& wish = observer.hello.picture;
    if (wish.rate_hz > 0 && std::ranges::find(wishes, wish) == wishes.end()) wishes.push_back(wish);
  }
  return wishes;
}

}  // namespace biteline::stream
