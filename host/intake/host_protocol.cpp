// SPDX-License-Identifier: MIT
#include "host/intake/host_protocol.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace biteline::intake {
namespace {

using std::chrono::milliseconds;

// All far below the sensor's patience with a silent host (2 s; PROTOCOL.md, "Times").
constexpr Nanoseconds k_hello_period = milliseconds{500};  ///< while nothing is heard
constexpr Nanoseconds k_ack_period = milliseconds{100};    ///< also the sign of life
/// Signs of life but no profile for so long: either none is made, or the last of a window went astray.
constexpr Nanoseconds k_stall = milliseconds{1000};
constexpr Nanoseconds k_rewind_period = milliseconds{200};  ///< what was asked for again needs time to come
/// An eighth of the sensor's window: it never stands still for want of an acknowledgement.
constexpr std::uint64_t k_ack_messages = 8;
/// A message that arrives broken after so many repetitions was broken when it left.
constexpr int k_broken_limit = 4;

Error farewell_error(const wire::Bye& bye) {
  switch (bye.reason) {
    case wire::ByeReason::VersionMismatch:
      return fail(Errc::NotSupported, "the sensor speaks protocol %d, this host %d",
                  static_cast<int>(bye.protocol), static_cast<int>(wire::k_protocol))
          .value();
    case wire::ByeReason::Refused:
      return fail(Errc::PeerRefused, "sensor: %s", bye.text.c_str()).value();
    case wire::ByeReason::Stopping:
      break;
  }
  return fail(Errc::ConnectionLost, "sensor: %s", bye.text.c_str()).value();
}

}  // namespace

HostProtocol::HostProtocol(HostProtocolConfig config, Send send)
    : config_{std::move(config)}, send_{std::move(send)} {
  if (config_.resume) {
    scan_id_ = config_.resume->scan_id;
    next_ = safe_ = acknowledged_ = config_.resume->next_sequence;
  }
}

Result<std::optional<LinkEvent>> HostProtocol::on_packet(std::span<const std::uint8_t> packet,
                                                         HostClock::time_point now) {
  Result<wire::Message> message = wire::decode(packet);
  heard_ = now;
  if (!message) return on_broken(message.error(), now);
  return on_message(std::move(*message), now);
}

Result<std::optional<LinkEvent>> HostProtocol::on_broken(const Error& error, HostClock::time_point now) {
  ++counters_.rejected;
  if (error.code == Errc::NotSupported) return tl::unexpected<Error>{error};
  if (!has_hello_ || !ask_again(now)) return std::optional<LinkEvent>{};
  broken_times_ = broken_at_ == next_ ? broken_times_ + 1 : 1;
  broken_at_ = next_;
  if (broken_times_ > k_broken_limit) {
    return fail(Errc::ProtocolError, "message %llu of the sensor stays broken: %s",
                static_cast<unsigned long long>(next_), error.where.c_str());
  }
  return std::optional<LinkEvent>{};
}

Result<std::optional<LinkEvent>> HostProtocol::on_message(wire::Message message, HostClock::time_point now) {
  if (auto* hello = std::get_if<wire::SensorHello>(&message.body))
    return on_hello(message.scan_id, std::move(*hello));
  if (const auto* bye = std::get_if<wire::Bye>(&message.body)) {
    // After the scan's end nothing is lost by a sensor that leaves.
    if (ended_ && bye->reason == wire::ByeReason::Stopping) return std::optional<LinkEvent>{};
    return tl::unexpected<Error>{farewell_error(*bye)};
  }
  // Sent before the hello that this host waits for, or of another scan.
  if (!has_hello_ || message.scan_id != scan_id_) return std::optional<LinkEvent>{};
  if (auto* profile = std::get_if<profile::Profile>(&message.body)) {
    if (!in_order(message.sequence, now)) return std::optional<LinkEvent>{};
    advance(now);
    return std::optional<LinkEvent>{
        ProfileEvent{.sequence = message.sequence, .profile = std::move(*profile)}};
  }
  if (auto* end = std::get_if<wire::EndOfScan>(&message.body)) {
    if (!in_order(message.sequence, now)) return std::optional<LinkEvent>{};
    ended_ = true;
    advance(now);
    return std::optional<LinkEvent>{std::move(*end)};
  }
  if (const auto* gap = std::get_if<wire::Gap>(&message.body)) return on_gap(*gap);
  if (auto* health = std::get_if<wire::Health>(&message.body))
    return std::optional<LinkEvent>{std::move(*health)};
  if (auto* reply = std::get_if<wire::ControlReply>(&message.body))
    return std::optional<LinkEvent>{std::move(*reply)};
  ++counters_.rejected;  // a host's message, from a sensor
  return std::optional<LinkEvent>{};
}

std::optional<LinkEvent> HostProtocol::on_hello(std::uint64_t scan_id, wire::SensorHello hello) {
  const bool same_scan = (has_hello_ || config_.resume) && scan_id == scan_id_;
  // Scan 0 is none; one that has ended lacks nothing.
  const bool other_scan = (has_hello_ || config_.resume) && !same_scan && scan_id_ != 0 && !ended_;
  if (has_hello_ && same_scan) return std::nullopt;  // the answer to a repeated hello
  has_hello_ = true;
  if (!same_scan) {
    scan_id_ = scan_id;
    next_ = safe_ = acknowledged_ = 0;
    ended_ = false;
  }
  return Hello{
      .sensor = std::move(hello), .scan_id = scan_id, .resumed = same_scan, .other_scan = other_scan};
}

std::optional<LinkEvent> HostProtocol::on_gap(const wire::Gap& gap) {
  const std::uint64_t end = gap.first + gap.count;
  if (gap.first > next_ || end <= next_)
    return std::nullopt;  // before or after what this host lacks: told again later
  const std::uint64_t lost = end - next_;
  counters_.lost += lost;
  // Safe only in the sense that nothing more can be done for them; what was given out before stays the
  // caller's affair.
  if (safe_ == next_) safe_ = end;
  next_ = end;
  return LossEvent{.messages = lost};
}

bool HostProtocol::in_order(std::uint64_t sequence, HostClock::time_point now) {
  if (sequence == next_) return true;
  if (sequence < next_) {
    ++counters_.duplicates;
  } else {
    ++counters_.out_of_order;
    (void)ask_again(now);
  }
  return false;
}

void HostProtocol::advance(HostClock::time_point now) {
  ++next_;
  progressed_ = now;
  ++counters_.messages;
  if (config_.acknowledge_by_itself) acknowledge(now);
}

void HostProtocol::acknowledge(HostClock::time_point now) {
  safe_ = next_;
  // The end at once: the caller may have no further call to make.
  if (safe_ - acknowledged_ >= k_ack_messages || (ended_ && safe_ > acknowledged_)) send_ack(now);
}

void HostProtocol::tick(HostClock::time_point now) {
  const bool unheard = now - std::max(heard_, hello_said_) > k_hello_period;
  const bool unanswered = !has_hello_ && now - hello_said_ > k_hello_period;
  const bool stalled = !ended_ && now - std::max(progressed_, hello_said_) > k_stall;
  if (unheard || unanswered || stalled) say_hello(now);
  if (!has_hello_) return;
  if (safe_ - acknowledged_ >= k_ack_messages || now - ack_said_ > k_ack_period) send_ack(now);
}

void HostProtocol::say_hello(HostClock::time_point now) {
  hello_said_ = now;
  ++counters_.hellos;
  const bool resume = has_hello_ || config_.resume.has_value();
  send(wire::HostHello{.name = config_.name,
                       .resume = resume,
                       .resume_scan_id = scan_id_,
                       .next_sequence = next_,
                       .safe_sequence = safe_});
}

bool HostProtocol::ask_again(HostClock::time_point now) {
  if (now - rewind_said_ < k_rewind_period) return false;
  rewind_said_ = now;
  ++counters_.rewinds;
  say_hello(now);
  return true;
}

void HostProtocol::send_ack(HostClock::time_point now) {
  ack_said_ = now;
  acknowledged_ = safe_;
  send(wire::Ack{.safe_sequence = safe_});
}

void HostProtocol::command(wire::Control control) {
  send(control);
}

void HostProtocol::say_bye() {
  send(wire::Bye{.reason = wire::ByeReason::Stopping, .text = "the host leaves"});
}

void HostProtocol::send(wire::Body body) {
  wire::encode({.scan_id = scan_id_, .body = std::move(body)}, scratch_);
  send_(scratch_);
}

}  // namespace biteline::intake
