// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor's side of the protocol, without sockets: hosts, their place in the stream, what is due to
/// whom.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "common/wire/messages.hpp"
#include "firmware/stream/message_store.hpp"
#include "firmware/stream/observers.hpp"
#include "firmware/stream/outbox.hpp"

namespace biteline::stream {

struct ServerConfig {
  std::size_t store_bytes{256 * 1024 * 1024};  ///< some 8000 full profiles: 80 s at 100 Hz
  std::uint64_t window_messages{64};           ///< sent and not yet acknowledged, per host
  /// Hosts say something at least four times a second (PROTOCOL.md); eight silent intervals and one is
  /// absent.
  Nanoseconds absent_after{2'000'000'000};
  /// Known again for that long, so that its place is not lost by a pause.
  Nanoseconds forgotten_after{60'000'000'000};
  Nanoseconds health_period{250'000'000};
  std::size_t max_hosts{4};
  ObserversConfig observers;
};

/// Hosts say hello, get the scan from where they ask, acknowledge.  All of several hosts get everything.
/// Observers get the newest of what they ask for, and change nothing.
/// Thread: one owner (the stream thread).
class StreamServer {
 public:
  using CommandHandler = std::function<Result<void>(wire::Command)>;
  /// Of a whole settings file.  Nothing: the answer comes by answer_settings().
  using SettingsHandler = std::function<std::optional<Result<void>>(const std::string& text)>;
  /// Of KeepLast or KeepNext; the answer comes by answer_keep(), or at once where it is a refusal.
  using KeepHandler = std::function<Result<void>(wire::Command)>;
  using HealthProvider = std::function<wire::Health()>;

  /// `identity`: what the sensor says of itself; its held range is filled in here.
  StreamServer(ServerConfig config, wire::SensorHello identity, Outbox& outbox, CommandHandler on_command,
               HealthProvider health);

  /// Without: hosts are told that the settings stand.
  void take_settings_by(SettingsHandler handler) { on_settings_ = std::move(handler); }
  /// To the host whose settings were not answered at once.  Pre: there is one.
  void answer_settings(const Result<void>& done);
  /// Without: hosts are told that nothing is recorded.
  void keep_recordings_by(KeepHandler handler) { on_keep_ = std::move(handler); }
  /// To the host that asked for a recording: what was kept.  Pre: there is one.
  void answer_keep(const Result<std::string>& kept);
  /// From the next hello on.
  void set_model(const geometry::SensorModel& model) { identity_.model = model; }
  void set_test_pattern(bool on) { identity_.test_pattern = on; }
  void set_camera_state(const geometry::CameraState& state) { identity_.camera_state = state; }

  /// A new scan: the store begins anew.  Messages of the old one that no host has are counted as lost.
  void begin_scan(std::uint64_t scan_id, const std::string& scan_name, std::uint64_t frames_expected);

  /// False: taking another message now would lose one that no host has yet.  Lossless sources wait then.
  [[nodiscard]] bool has_room() const;

  void add_profile(const profile::ProfileHeader& header, std::span<const profile::ProfilePoint> points);
  /// The scan's last message.
  void add_end(wire::EndOfScan end);

  /// The scan's beginning as hosts get it, and the message that was added last.  Valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> hello_message();
  /// Pre: one was added.
  [[nodiscard]] std::span<const std::uint8_t> newest_message() const {
    return store_.at(store_.held_to() - 1);
  }

  /// A packet of a host, from anyone.
  void on_packet(const PeerId& peer, std::span<const std::uint8_t> packet, SensorClock::time_point now);

  /// To the observers that wish for it; nothing when it is of another scan.
  void add_picture(const MadePicture& picture);
  [[nodiscard]] std::uint64_t scan_id() const { return scan_id_; }
  [[nodiscard]] const Observers& observers() const { return observers_; }

  /// Sends what is due.  To be called often.
  void tick(SensorClock::time_point now);

  /// Tells every host that the sensor stops.
  void say_bye(const std::string& text);

  [[nodiscard]] std::size_t hosts_present() const;
  /// Those for whom the present scan is: who asked for it, and who has acknowledged something of it.  A
  /// program that only brings settings is none of them.
  [[nodiscard]] std::size_t hosts_taking() const;
  /// True when every present host has acknowledged the scan's end, and at least one has.
  [[nodiscard]] bool end_acknowledged() const;
  /// Messages lost, packets rejected, hosts refused: this module's part of the counters.
  void fill(wire::Counters& counters) const;
  void count_refused_peer() { ++peers_refused_; }

 private:
  struct Host {
    std::string name;
    std::uint64_t next{0};  ///< next message to send
    std::uint64_t acknowledged{0};
    std::uint64_t given_from{0};  ///< first message that it got; those before were gone
    SensorClock::time_point heard;
    bool present{true};
    bool has_end{false};  ///< acknowledged the end of a scan that is over
  };
  void send(const PeerId& peer, const wire::Message& message);
  void encode_hello();  ///< into scratch_
  void send_hello(const PeerId& peer);
  void reply(const PeerId& peer, std::uint32_t id, const Result<void>& done, const std::string& words = {});
  void send_due(const PeerId& peer, Host& host);
  void on_hello(const PeerId& peer, const wire::HostHello& hello, SensorClock::time_point now);
  void on_observer(const PeerId& peer, const wire::ObserverHello& hello, SensorClock::time_point now);
  void on_observers_message(const PeerId& peer, const wire::Message& message);
  void on_ack(Host& host, std::uint64_t scan_id, const wire::Ack& ack);
  /// Errc::PeerRefused: the scan is another host's.
  [[nodiscard]] Result<void> check_owner(const PeerId& peer);
  [[nodiscard]] Result<void> obey(const PeerId& peer, wire::Command command);
  void on_settings(const PeerId& peer, const wire::Control& control);
  void on_keep(const PeerId& peer, const wire::Control& control);
  void on_control(const PeerId& peer, const wire::Control& control);
  void update_acknowledged();
  void drop_silent_hosts(SensorClock::time_point now);
  void refuse(const PeerId& peer, wire::ByeReason reason, const std::string& text);

  ServerConfig config_;
  wire::SensorHello identity_;
  Outbox& outbox_;
  CommandHandler on_command_;
  SettingsHandler on_settings_;
  KeepHandler on_keep_;
  HealthProvider health_;
  MessageStore store_;
  std::map<PeerId, Host> hosts_;
  Observers observers_;
  std::optional<std::uint64_t> newest_profile_;  ///< its number in the store
  std::optional<PeerId> owner_;                  ///< of the running scan: the host that asked for it
  struct Question {
    PeerId peer;
    std::uint32_t id{0};
  };
  std::optional<Question> settings_asked_;  ///< not answered yet
  std::optional<Question> keep_asked_;      ///< likewise
  std::uint64_t scan_id_{0};
  bool ended_{false};
  bool end_delivered_{false};  ///< at least one host has the end, even if it has left since
  SensorClock::time_point health_due_;
  std::uint64_t messages_lost_{0};
  std::uint64_t packets_rejected_{0};
  std::uint64_t peers_refused_{0};
  wire::Bytes scratch_;
};

}  // namespace biteline::stream
