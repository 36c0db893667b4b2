// SPDX-License-Identifier: MIT
#include "host/apps/biteline/settings_live.hpp"

#include <chrono>
#include <optional>
#include <variant>

#include "common/wire/observer.hpp"
#include "host/intake/sensor_link.hpp"

namespace biteline::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Nanoseconds k_turn = std::chrono::milliseconds{50};
/// A network camera is opened, told and read back within some hundred ms.
constexpr std::chrono::seconds k_patience{10};
constexpr std::uint32_t k_id = 1;
constexpr std::uint16_t k_least_minor = 2;

Result<std::optional<wire::HostKeys>> keys_of(const SensorAddress& address) {
  if (address.keys.empty()) return std::optional<wire::HostKeys>{};
  BITELINE_ASSIGN(wire::HostKeys keys, wire::read_host_keys(address.keys));
  return std::optional{std::move(keys)};
}

Result<void> check_version(const wire::SensorHello& sensor) {
  if (sensor.protocol_minor >= k_least_minor) return {};
  return fail(Errc::NotSupported, "%s takes no settings over the network: it is older than protocol 1.2",
              sensor.name.c_str());
}

}  // namespace

Result<void> send_settings(const SensorAddress& address, const settings::SettingsSet& set) {
  intake::SensorLinkConfig config;
  BITELINE_ASSIGN(config.sensor, wire::parse_endpoint(address.endpoint));
  BITELINE_ASSIGN(config.keys, keys_of(address));
  config.protocol.name = "biteline settings";
  // The scans are others': nothing of them is safe here.
  config.protocol.acknowledge_by_itself = false;
  BITELINE_ASSIGN(const std::unique_ptr<intake::SensorLink> link, intake::SensorLink::open(config));
  bool sent = false;
  for (const Clock::time_point deadline = Clock::now() + k_patience; Clock::now() < deadline;) {
    BITELINE_ASSIGN(const std::optional<intake::LinkEvent> event, link->next(k_turn));
    if (!event) continue;
    if (const auto* hello = std::get_if<intake::Hello>(&*event)) {
      BITELINE_TRY(check_version(hello->sensor));
      if (!sent)
        link->command(
            {.id = k_id, .command = wire::Command::UseSettings, .settings = settings::settings_text(set)});
      sent = true;
    }
    const auto* reply = std::get_if<wire::ControlReply>(&*event);
    if (reply == nullptr || reply->id != k_id) continue;
    if (reply->errc == 0) return {};
    return fail(Errc::PeerRefused, "the sensor keeps its settings: %s", reply->where.c_str());
  }
  return fail(Errc::Timeout, "the sensor at %s does not say whether it takes the settings",
              address.endpoint.c_str());
}

Result<std::string> fetch_settings(const SensorAddress& address) {
  wire::ObserverConfig config;
  BITELINE_ASSIGN(config.sensor, wire::parse_endpoint(address.endpoint));
  BITELINE_ASSIGN(config.keys, keys_of(address));
  config.wish.name = "biteline settings";
  BITELINE_ASSIGN(const std::unique_ptr<wire::Observer> observer, wire::Observer::open(config));
  for (const Clock::time_point deadline = Clock::now() + k_patience; Clock::now() < deadline;) {
    BITELINE_ASSIGN(const std::optional<wire::Message> message, observer->next(k_turn));
    if (!message) continue;
    if (const auto* hello = std::get_if<wire::SensorHello>(&message->body)) {
      BITELINE_TRY(check_version(*hello));
      if (hello->lossless) return fail(Errc::NotSupported, "%s plays a recording", hello->name.c_str());
    }
    if (const auto* health = std::get_if<wire::Health>(&message->body); health && health->settings)
      return health->settings->text;
  }
  return fail(Errc::Timeout, "no word of a sensor at %s", address.endpoint.c_str());
}

}  // namespace biteline::app
