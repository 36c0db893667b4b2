// SPDX-License-Identifier: MIT
#pragma once
/// \file The stream thread: profiles from the scanner into the store and out to the hosts.

#include <atomic>
#include <memory>
#include <optional>

#include "firmware/app/scanner.hpp"
#include "firmware/stream/stream_socket.hpp"

namespace biteline::sensor {

struct StreamerConfig {
  stream::ServerConfig server;
  std::string name{"biteline-sensor"};
  std::string version;
  std::uint64_t scan_id{0};
  bool leave_after_scan{false};  ///< once the scan's end was acknowledged: a recording is played once
};

/// Runs on its caller's thread.
class Streamer {
 public:
  Streamer(const StreamerConfig& config, Scanner& scanner, stream::StreamSocket& socket, const hal::Clock& clock);

  /// Until `stop` is set, or the scan is over and delivered (leave_after_scan).  Says goodbye to the hosts.
  void run(const std::atomic<bool>& stop);

  /// The scan's end went out, and why it ended.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  void take_profiles();
  void announce_end();
  [[nodiscard]] bool delivered();
  [[nodiscard]] wire::Counters counters() const;
  [[nodiscard]] std::vector<wire::StageTime> stages() const;
  [[nodiscard]] wire::Health health() const;
  [[nodiscard]] Result<void> obey(wire::Command command);

  StreamerConfig config_;
  Scanner& scanner_;
  stream::StreamSocket& socket_;
  const hal::Clock& clock_;
  stream::StreamServer server_;
  runtime::StageMeter encode_meter_;
  bool ended_{false};
  std::optional<SensorClock::time_point> acknowledged_at_;
};

}  // namespace biteline::sensor
