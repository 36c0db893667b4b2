// SPDX-License-Identifier: MIT
#include "biteline/sensor.hpp"

#include "common/wire/scan_file.hpp"
#include "host/intake/scan_journal.hpp"
#include "host/intake/sensor_link.hpp"
#include "host/library/source/inside.hpp"

namespace biteline::sdk {
namespace {

using std::chrono::steady_clock;

/// The sensor counts a host as absent that is silent for longer.
constexpr std::chrono::milliseconds k_turn{50};

}  // namespace

struct SensorClient::State {
  intake::SensorLinkConfig config;
};

SensorClient::SensorClient(const SensorOptions& options) : state_{std::make_unique<State>()} {
  state_->config.sensor = or_throw(wire::parse_endpoint(options.endpoint));
  if (!options.keys.empty()) state_->config.keys = or_throw(wire::read_host_keys(options.keys));
  if (options.keys.empty() && !state_->config.sensor.loopback())
    throw Error{options.endpoint + ": not on this machine, and no keys were given",
                "make keys with `biteline keys`, and give their folder"};
  state_->config.protocol.name = options.name;
  // What is not yet in the file is not safe.
  state_->config.protocol.acknowledge_by_itself = false;
}

SensorClient::SensorClient(SensorClient&&) noexcept = default;
SensorClient& SensorClient::operator=(SensorClient&&) noexcept = default;
SensorClient::~SensorClient() = default;

namespace {

/// One scan on its way into a file.
class Scan {
 public:
  Scan(intake::SensorLink& link, intake::ScanJournal& journal) : link_{link}, journal_{journal} {}

  /// True at the scan's end.
  bool take(const intake::LinkEvent& event) {
    if (const auto* hello = std::get_if<intake::Hello>(&event)) return take(*hello);
    if (const auto* reply = std::get_if<wire::ControlReply>(&event)) {
      if (reply->errc != 0) throw Error{"the sensor starts no scan: " + reply->where, "see its own words"};
      return false;
    }
    const auto* end = std::get_if<wire::EndOfScan>(&event);
    if (end == nullptr && !std::holds_alternative<intake::ProfileEvent>(event)) return false;
    or_throw(journal_.append(link_.packet()));
    link_.acknowledge();
    if (end != nullptr && end->errc != 0)
      throw Error{"the sensor ended the scan: " + end->where, "see its words, then scan again"};
    return end != nullptr;
  }

 private:
  bool take(const intake::Hello& hello) {
    if (hello.other_scan && begun_)
      throw Error{"the sensor began another scan", "let one program at a time start scans"};
    const bool waits = hello.sensor.held_to > hello.sensor.held_from;
    if (hello.scan_id != 0 && (hello.sensor.scanning || waits || asked_)) {
      if (!begun_) or_throw(journal_.append(link_.packet()));
      begun_ = true;
    } else if (!asked_) {
      link_.command({.id = 1, .command = wire::Command::StartScan});
      asked_ = true;
    }
    return false;
  }

  intake::SensorLink& link_;
  intake::ScanJournal& journal_;
  bool asked_{false}, begun_{false};
};

}  // namespace

Recording SensorClient::scan(const std::filesystem::path& file, std::chrono::milliseconds timeout) {
  const std::unique_ptr<intake::SensorLink> link = or_throw(intake::SensorLink::open(state_->config));
  {
    intake::ScanJournal journal = or_throw(intake::ScanJournal::create(file));
    Scan scan{*link, journal};
    const steady_clock::time_point until = steady_clock::now() + timeout;
    bool ended = false;
    while (!ended) {
      if (steady_clock::now() > until) {
        link->command({.id = 2, .command = wire::Command::StopScan});
        static_cast<void>(link->next(k_turn));
        throw Error{"the scan did not end within " + std::to_string(timeout.count()) + " ms; it is stopped",
                    "give it more time, or look whether the arm moves"};
      }
      const std::optional<intake::LinkEvent> event = or_throw(link->next(k_turn));
      if (event) ended = scan.take(*event);
    }
  }
  return read_recording(file);
}

}  // namespace biteline::sdk
