// SPDX-License-Identifier: MIT
#include "firmware/stream/stream_server.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>

#include "common/core/contracts.hpp"

namespace biteline::stream {
namespace {

/// What a profile takes at most (see wire::k_max_message_bytes); typical ones take a quarter.
constexpr std::size_t k_large_profile_bytes = 224 * 1024;

}  // namespace

StreamServer::StreamServer(ServerConfig config, wire::SensorHello identity, Outbox& outbox,
                           CommandHandler on_command, HealthProvider health)
    : config_{config},
      identity_{std::move(identity)},
      outbox_{outbox},
      on_command_{std::move(on_command)},
      health_{std::move(health)},
      store_{config.store_bytes},
      observers_{config.observers, outbox} {}

void StreamServer::begin_scan(std::uint64_t scan_id, const std::string& scan_name,
                              std::uint64_t frames_expected) {
  messages_lost_ += store_.clear();
  scan_id_ = scan_id;
  ended_ = false;
  end_delivered_ = false;
  identity_.scan_name = scan_name;
  identity_.frames_expected = frames_expected;
  identity_.scanning = true;
  for (auto& [peer, host] : hosts_) {
    host.next = 0;
    host.acknowledged = 0;
    host.given_from = 0;
    host.has_end = false;
    send_hello(peer);
  }
  newest_profile_.reset();
  observers_.begin_scan();
  encode_hello();
  observers_.tell(scratch_);
}

bool StreamServer::has_room() const {
  return store_.has_room(k_large_profile_bytes);
}

void StreamServer::add_profile(const profile::ProfileHeader& header,
                               std::span<const profile::ProfilePoint> points) {
  wire::Bytes packet;
  newest_profile_ = store_.held_to();
  wire::encode_profile({.scan_id = scan_id_, .sequence = *newest_profile_}, header, points, packet);
  messages_lost_ += store_.push(std::move(packet));
}

void StreamServer::add_end(wire::EndOfScan end) {
  fill(end.counters);
  wire::Bytes packet;
  wire::encode({.scan_id = scan_id_, .sequence = store_.held_to(), .body = std::move(end)}, packet);
  observers_.tell(packet);
  messages_lost_ += store_.push(std::move(packet));
  ended_ = true;
  owner_.reset();
  identity_.scanning = false;
}

void StreamServer::add_picture(const MadePicture& picture) {
  if (picture.scan_id == scan_id_) observers_.offer_picture(picture);
}

void StreamServer::on_packet(const PeerId& peer, std::span<const std::uint8_t> packet,
                             SensorClock::time_point now) {
  const Result<wire::Message> message = wire::decode(packet);
  if (!message) {
    ++packets_rejected_;
    if (message.error().code == Errc::NotSupported) {
      refuse(peer, wire::ByeReason::VersionMismatch, to_line(message.error()));
    }
    return;
  }
  if (const auto* hello = std::get_if<wire::ObserverHello>(&message->body))
    return on_observer(peer, *hello, now);
  if (observers_.contains(peer)) return on_observers_message(peer, *message);
  if (const auto* hello = std::get_if<wire::HostHello>(&message->body)) return on_hello(peer, *hello, now);

  const auto known = hosts_.find(peer);
  if (known == hosts_.end()) {
    // A host whose connection was renewed, or a stranger: whoever it is, hello comes first.  Hosts say it
    // again by themselves when they hear nothing.
    ++packets_rejected_;
    return;
  }
  Host& host = known->second;
  host.heard = now;
  host.present = true;
  if (const auto* ack = std::get_if<wire::Ack>(&message->body)) {
    on_ack(host, message->scan_id, *ack);
  } else if (const auto* control = std::get_if<wire::Control>(&message->body)) {
    on_control(peer, *control);
  } else if (std::holds_alternative<wire::Bye>(message->body)) {
    hosts_.erase(known);
  } else {
    ++packets_rejected_;
  }
  update_acknowledged();
}

void StreamServer::on_observer(const PeerId& peer, const wire::ObserverHello& hello,
                               SensorClock::time_point now) {
  if (hosts_.contains(peer)) {
    ++packets_rejected_;
    return;
  }
  switch (observers_.on_hello(peer, hello, now)) {
    case Observers::Welcome::Known:
      return;
    case Observers::Welcome::New:
      return send_hello(peer);
    case Observers::Welcome::NoPlace:
      return refuse(peer, wire::ByeReason::Refused,
                    "the sensor already has " + std::to_string(observers_.count()) + " observers");
  }
}

void StreamServer::on_observers_message(const PeerId& peer, const wire::Message& message) {
  if (std::holds_alternative<wire::Bye>(message.body)) return observers_.erase(peer);
  ++packets_rejected_;
  if (const auto* control = std::get_if<wire::Control>(&message.body)) {
    reply(peer, control->id, fail(Errc::PeerRefused, "an observer cannot command; connect as a host"));
  }
}

void StreamServer::on_hello(const PeerId& peer, const wire::HostHello& hello, SensorClock::time_point now) {
  if (!hosts_.contains(peer) && hosts_.size() >= config_.max_hosts) {
    // A host that connects anew leaves its old address behind: the absent go first.
    std::erase_if(hosts_, [](const auto& entry) { return !entry.second.present; });
    if (hosts_.size() >= config_.max_hosts) {
      refuse(peer, wire::ByeReason::Refused,
             "the sensor already serves " + std::to_string(hosts_.size()) + " hosts");
      return;
    }
  }
  Host& host = hosts_[peer];
  host.name = hello.name;
  host.heard = now;
  host.present = true;
  // A host that holds the beginning of another scan starts with this one's first message; it learns that from
  // the hello.
  const bool resumes = hello.resume && hello.resume_scan_id == scan_id_;
  host.next = resumes ? std::min(hello.next_sequence, store_.held_to()) : 0;
  host.acknowledged = resumes ? std::min(hello.safe_sequence, host.next) : 0;
  host.given_from = 0;
  host.has_end = false;
  update_acknowledged();
  send_hello(peer);
}

void StreamServer::on_ack(Host& host, std::uint64_t scan_id, const wire::Ack& ack) {
  if (scan_id != scan_id_) return;      // on its way when the scan changed
  if (ack.safe_sequence > host.next) {  // what was never sent cannot be safe
    ++packets_rejected_;
    return;
  }
  host.acknowledged = std::max(host.acknowledged, ack.safe_sequence);
  host.has_end = ended_ && host.acknowledged == store_.held_to();
  end_delivered_ = end_delivered_ || host.has_end;
}

Result<void> StreamServer::check_owner(const PeerId& peer) {
  // Whoever began the scan owns it while it runs and it is there; another host may listen, and no more.
  if (!owner_ || *owner_ == peer || !identity_.scanning) return {};
  const auto owner = hosts_.find(*owner_);
  if (owner == hosts_.end() || !owner->second.present) return {};
  ++packets_rejected_;
  return fail(Errc::PeerRefused, "the scan belongs to host '%s'", owner->second.name.c_str());
}

Result<void> StreamServer::obey(const PeerId& peer, wire::Command command) {
  BITELINE_TRY(check_owner(peer));
  BITELINE_TRY(on_command_(command));
  if (command == wire::Command::StartScan) owner_ = peer;
  return {};
}

void StreamServer::on_settings(const PeerId& peer, const wire::Control& control) {
  if (const Result<void> allowed = check_owner(peer); !allowed) return reply(peer, control.id, allowed);
  if (settings_asked_)
    return reply(peer, control.id, fail(Errc::WrongState, "the settings before are still being taken"));
  if (!on_settings_) return reply(peer, control.id, fail(Errc::NotSupported, "this sensor's settings stand"));
  settings_asked_ = Question{.peer = peer, .id = control.id};
  if (const std::optional<Result<void>> done = on_settings_(control.settings)) answer_settings(*done);
}

void StreamServer::answer_settings(const Result<void>& done) {
  BITELINE_EXPECTS(settings_asked_.has_value());
  const Question asked = *std::exchange(settings_asked_, std::nullopt);
  reply(asked.peer, asked.id, done);
  health_due_ = {};  // what holds now is told at once
}

void StreamServer::on_keep(const PeerId& peer, const wire::Control& control) {
  if (const Result<void> allowed = check_owner(peer); !allowed) return reply(peer, control.id, allowed);
  if (keep_asked_)
    return reply(peer, control.id, fail(Errc::WrongState, "the request before is still under way"));
  if (!on_keep_) return reply(peer, control.id, fail(Errc::NotSupported, "this sensor records nothing"));
  if (const Result<void> begun = on_keep_(control.command); !begun) return reply(peer, control.id, begun);
  keep_asked_ = Question{.peer = peer, .id = control.id};
}

void StreamServer::answer_keep(const Result<std::string>& kept) {
  BITELINE_EXPECTS(keep_asked_.has_value());
  const Question asked = *std::exchange(keep_asked_, std::nullopt);
  if (!kept) return reply(asked.peer, asked.id, tl::unexpected<Error>{kept.error()});
  reply(asked.peer, asked.id, {}, *kept);
}

void StreamServer::on_control(const PeerId& peer, const wire::Control& control) {
  if (control.command == wire::Command::UseSettings) return on_settings(peer, control);
  if (control.command == wire::Command::KeepLast || control.command == wire::Command::KeepNext)
    return on_keep(peer, control);
  reply(peer, control.id, obey(peer, control.command));
}

void StreamServer::reply(const PeerId& peer, std::uint32_t id, const Result<void>& done,
                         const std::string& words) {
  wire::ControlReply reply{.id = id, .errc = 0, .where = words};
  if (!done) {
    reply.errc = static_cast<std::uint16_t>(done.error().code);
    reply.where = done.error().where.c_str();
  }
  send(peer, {.scan_id = scan_id_, .body = std::move(reply)});
}

void StreamServer::tick(SensorClock::time_point now) {
  drop_silent_hosts(now);
  for (auto& [peer, host] : hosts_) {
    if (host.present) send_due(peer, host);
  }
  observers_.drop_silent(now);
  if (newest_profile_ && *newest_profile_ >= store_.held_from())
    observers_.offer_profile(*newest_profile_, store_.at(*newest_profile_), now);
  if (now < health_due_) return;
  health_due_ = now + config_.health_period;
  wire::Health health = health_();
  fill(health.counters);
  health.observers = static_cast<std::uint32_t>(observers_.count());
  wire::encode({.scan_id = scan_id_, .body = std::move(health)}, scratch_);
  observers_.tell(scratch_);
  for (auto& [peer, host] : hosts_) {
    if (host.present) outbox_.send(peer, scratch_);
  }
}

void StreamServer::send_due(const PeerId& peer, Host& host) {
  if (host.next < store_.held_from()) {
    const wire::Gap gap{.first = host.next, .count = store_.held_from() - host.next};
    wire::encode({.scan_id = scan_id_, .body = gap}, scratch_);
    if (!outbox_.send(peer, scratch_)) return;
    host.next = host.given_from = store_.held_from();
    // The host has nothing of the gap to acknowledge; its window starts behind it.
    host.acknowledged = std::max(host.acknowledged, host.next);
  }
  const std::uint64_t end = std::min(store_.held_to(), host.acknowledged + config_.window_messages);
  const std::uint64_t before = host.next;
  while (host.next < end && outbox_.send(peer, store_.at(host.next))) ++host.next;
  // Who was given the scan's end waits for what the light did until then.
  if (ended_ && host.next > before && host.next == store_.held_to()) health_due_ = {};
}

void StreamServer::say_bye(const std::string& text) {
  wire::encode({.scan_id = scan_id_, .body = wire::Bye{.reason = wire::ByeReason::Stopping, .text = text}},
               scratch_);
  for (const auto& [peer, host] : hosts_) outbox_.send(peer, scratch_);
  observers_.tell(scratch_);
}

void StreamServer::refuse(const PeerId& peer, wire::ByeReason reason, const std::string& text) {
  ++peers_refused_;
  send(peer, {.scan_id = scan_id_, .body = wire::Bye{.reason = reason, .text = text}});
}

void StreamServer::encode_hello() {
  wire::SensorHello hello = identity_;
  hello.held_from = store_.held_from();
  hello.held_to = store_.held_to();
  wire::encode({.scan_id = scan_id_, .body = std::move(hello)}, scratch_);
}

std::span<const std::uint8_t> StreamServer::hello_message() {
  encode_hello();
  return scratch_;
}

void StreamServer::send_hello(const PeerId& peer) {
  encode_hello();
  outbox_.send(peer, scratch_);
}

void StreamServer::send(const PeerId& peer, const wire::Message& message) {
  wire::encode(message, scratch_);
  outbox_.send(peer, scratch_);
}

void StreamServer::drop_silent_hosts(SensorClock::time_point now) {
  for (auto& [peer, host] : hosts_) {
    if (now - host.heard > config_.absent_after) host.present = false;
  }
  std::erase_if(hosts_,
                [&](const auto& entry) { return now - entry.second.heard > config_.forgotten_after; });
  update_acknowledged();
}

void StreamServer::update_acknowledged() {
  // Without any host the last word stands: what nobody acknowledged is kept for whoever comes.
  std::uint64_t lowest = std::numeric_limits<std::uint64_t>::max();
  for (const auto& [peer, host] : hosts_) {
    if (host.present) lowest = std::min(lowest, host.acknowledged);
  }
  if (lowest != std::numeric_limits<std::uint64_t>::max()) store_.set_acknowledged(lowest);
}

std::size_t StreamServer::hosts_present() const {
  return static_cast<std::size_t>(
      std::count_if(hosts_.begin(), hosts_.end(), [](const auto& entry) { return entry.second.present; }));
}

std::size_t StreamServer::hosts_taking() const {
  return static_cast<std::size_t>(std::count_if(hosts_.begin(), hosts_.end(), [this](const auto& entry) {
    const Host& host = entry.second;
    return host.present && (entry.first == owner_ || host.acknowledged > host.given_from);
  }));
}

bool StreamServer::end_acknowledged() const {
  const auto lacks_end = [](const auto& entry) { return entry.second.present && !entry.second.has_end; };
  return end_delivered_ && std::none_of(hosts_.begin(), hosts_.end(), lacks_end);
}

void StreamServer::fill(wire::Counters& counters) const {
  counters.messages_lost = messages_lost_;
  counters.packets_rejected = packets_rejected_;
  counters.peers_refused = peers_refused_;
}

}  // namespace biteline::stream
