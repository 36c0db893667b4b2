// SPDX-License-Identifier: MIT
#pragma once
/// \file A connection to a sensor: connects, resumes, verifies, acknowledges, and says when it is over.

#include <memory>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/wire/endpoint.hpp"
#include "common/wire/keys.hpp"
#include "host/intake/host_protocol.hpp"

namespace biteline::intake {

struct SensorLinkConfig {
  wire::Endpoint sensor;
  std::optional<wire::HostKeys> keys;  ///< compulsory beyond loopback
  HostProtocolConfig protocol;
  /// Without a word from the sensor for so long the link is over.  Connections that break are renewed
  /// meanwhile.
  Nanoseconds silence_limit{std::chrono::seconds{5}};
};

/// Thread: one owner.  Call next() at least four times a second, or the sensor counts this host as absent
/// (and sends everything missed when it calls again).
class SensorLink {
 public:
  /// Starts to connect; the first event is a Hello.
  [[nodiscard]] static Result<std::unique_ptr<SensorLink>> open(const SensorLinkConfig& config);
  ~SensorLink();  ///< says goodbye

  /// The next event, or nothing within `timeout`.  An Error ends the link: refused key, other version,
  /// silence, goodbye, a message that stays broken.
  [[nodiscard]] Result<std::optional<LinkEvent>> next(Nanoseconds timeout);

  /// The message behind the last event, as it came.  Valid until the next call of next().
  [[nodiscard]] std::span<const std::uint8_t> packet() const;

  /// With acknowledge_by_itself off: everything given out so far is safe.
  void acknowledge();
  void command(wire::Control control);

  [[nodiscard]] ScanPosition position() const;
  [[nodiscard]] const LinkCounters& counters() const;
  [[nodiscard]] int reconnects() const;

 private:
  struct State;
  explicit SensorLink(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::intake
