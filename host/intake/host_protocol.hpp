// SPDX-License-Identifier: MIT
#pragma once
/// \file The host's side of the protocol, without sockets: order, gaps, acknowledgements.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "common/wire/messages.hpp"

namespace biteline::intake {

/// Where a host stands in a scan: what it must keep to go on after its own end.
struct ScanPosition {
  std::uint64_t scan_id{0};
  std::uint64_t next_sequence{0};
};

/// What happened, in order.
struct Hello {
  wire::SensorHello sensor;
  std::uint64_t scan_id{0};
  bool resumed{false};     ///< goes on where this host stood
  bool other_scan{false};  ///< the sensor began another scan: the rest of the former one will not come
};
struct ProfileEvent {
  std::uint64_t sequence{0};
  profile::Profile profile;
};
struct LossEvent {
  std::uint64_t messages{0};  ///< gone for good
};
using LinkEvent =
    std::variant<Hello, ProfileEvent, wire::Health, wire::EndOfScan, LossEvent, wire::ControlReply>;

struct LinkCounters {
  std::uint64_t messages{0};      ///< given out in order
  std::uint64_t lost{0};          ///< the sensor no longer had them
  std::uint64_t duplicates{0};    ///< came again; harmless
  std::uint64_t out_of_order{0};  ///< came after a hole; asked for again
  std::uint64_t rejected{0};      ///< failed verification
  std::uint64_t rewinds{0};
  std::uint64_t hellos{0};  ///< said
};

struct HostProtocolConfig {
  std::string name{"biteline-host"};
  std::optional<ScanPosition> resume;
  /// true: what was given out counts as safe.  false: the caller says so by acknowledge().
  bool acknowledge_by_itself{true};
};

/// Thread: one owner.
class HostProtocol {
 public:
  using Send = std::function<void(std::span<const std::uint8_t>)>;

  HostProtocol(HostProtocolConfig config, Send send);

  /// What the packet means, if anything for the caller.  An Error ends the link: other version, refused,
  /// sensor stops, a message that stays broken.
  [[nodiscard]] Result<std::optional<LinkEvent>> on_packet(std::span<const std::uint8_t> packet,
                                                           HostClock::time_point now);

  /// Says hello, acknowledges, asks again: to be called a hundred times a second.
  void tick(HostClock::time_point now);

  /// The connection was made or made again.
  void on_connected(HostClock::time_point now) { say_hello(now); }

  /// Everything given out so far is safe.
  void acknowledge(HostClock::time_point now);

  void command(wire::Control control);
  void say_bye();

  [[nodiscard]] ScanPosition position() const { return {.scan_id = scan_id_, .next_sequence = next_}; }
  [[nodiscard]] bool has_hello() const { return has_hello_; }
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] HostClock::time_point heard() const { return heard_; }
  [[nodiscard]] const LinkCounters& counters() const { return counters_; }

 private:
  [[nodiscard]] Result<std::optional<LinkEvent>> on_message(wire::Message message, HostClock::time_point now);
  [[nodiscard]] Result<std::optional<LinkEvent>> on_broken(const Error& error, HostClock::time_point now);
  [[nodiscard]] std::optional<LinkEvent> on_hello(std::uint64_t scan_id, wire::SensorHello hello);
  [[nodiscard]] std::optional<LinkEvent> on_gap(const wire::Gap& gap);
  /// True: `sequence` is the one that is due.
  [[nodiscard]] bool in_order(std::uint64_t sequence, HostClock::time_point now);
  void advance(HostClock::time_point now);
  void say_hello(HostClock::time_point now);
  /// False: asked only just now.
  bool ask_again(HostClock::time_point now);
  void send_ack(HostClock::time_point now);
  void send(wire::Body body);

  HostProtocolConfig config_;
  Send send_;
  bool has_hello_{false};
  bool ended_{false};
  std::uint64_t scan_id_{0};
  std::uint64_t next_{0};
  std::uint64_t safe_{0};
  std::uint64_t acknowledged_{0};
  HostClock::time_point heard_, progressed_, hello_said_, ack_said_, rewind_said_;
  std::uint64_t broken_at_{0};
  int broken_times_{0};
  LinkCounters counters_;
  wire::Bytes scratch_;
};

}  // namespace biteline::intake
