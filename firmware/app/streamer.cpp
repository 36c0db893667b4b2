// SPDX-License-Identifier: MIT
#include "firmware/app/streamer.hpp"

#include <chrono>
#include <string>
#include <utility>

namespace biteline::sensor {
namespace {

using std::chrono::milliseconds;

/// Longest sleep while nothing comes from the hosts: bounds what the network adds to a profile's age.
constexpr Nanoseconds k_idle_wait = milliseconds{1};
/// Between two looks at the network.
constexpr int k_profiles_per_turn = 16;
/// After the scan's end was acknowledged hosts have so long to say goodbye.
constexpr Nanoseconds k_farewell = milliseconds{500};

wire::SensorHello identity_of(const StreamerConfig& config, const Source& source) {
  wire::SensorHello hello;
  hello.name = config.name;
  hello.version = config.version;
  hello.lossless = source.lossless;
  hello.simulated = source.simulated;
  hello.model = source.model;
  return hello;
}

wire::StageTime stage_time(const char* name, const runtime::StageMeter& meter) {
  const runtime::StageMeter::Summary summary = meter.summary();
  return {.name = name, .count = summary.count, .min = summary.min, .mean = summary.mean, .max = summary.max};
}

}  // namespace

Streamer::Streamer(const StreamerConfig& config, Scanner& scanner, stream::StreamSocket& socket, const hal::Clock& clock)
    : config_{config},
      scanner_{scanner},
      socket_{socket},
      clock_{clock},
      server_{config.server, identity_of(config, scanner.source()), socket,
              [this](wire::Command command) { return obey(command); }, [this] { return health(); }} {
  server_.begin_scan(config_.scan_id, scanner_.source().scan_name, scanner_.source().frames_expected);
}

void Streamer::run(const std::atomic<bool>& stop) {
  const stream::StreamSocket::Sink on_packet = [&](const stream::PeerId& peer, std::span<const std::uint8_t> packet) {
    server_.on_packet(peer, packet, clock_.now());
  };
  while (!stop && !delivered()) {
    const int refused = socket_.receive(scanner_.waiting() ? Nanoseconds{0} : k_idle_wait, on_packet);
    for (int i = 0; i < refused; ++i) server_.count_refused_peer();
    take_profiles();
    if (!ended_ && scanner_.finished()) announce_end();
    server_.tick(clock_.now());
  }
  server_.say_bye(stop ? "the sensor was told to stop" : "the scan is over");
}

void Streamer::take_profiles() {
  for (int i = 0; i < k_profiles_per_turn; ++i) {
    if (scanner_.source().lossless && !server_.has_room()) return;
    const profile::ProfileBuffer* profile = scanner_.take();
    if (profile == nullptr) return;
    const SensorClock::time_point begin = clock_.now();
    server_.add_profile(profile->header, profile->view());
    encode_meter_.rt_add(clock_.now() - begin);
    scanner_.give_back();
  }
}

void Streamer::announce_end() {
  wire::EndOfScan end;
  if (const std::optional<Error> failure = scanner_.failure()) {
    end.errc = static_cast<std::uint16_t>(failure->code);
    end.where = failure->where.c_str();
  }
  end.counters = counters();
  end.stages = stages();
  server_.add_end(std::move(end));
  ended_ = true;
}

bool Streamer::delivered() {
  if (!config_.leave_after_scan || !ended_) return false;
  if (!acknowledged_at_ && server_.end_acknowledged()) acknowledged_at_ = clock_.now();
  if (!acknowledged_at_) return false;
  return server_.hosts_present() == 0 || clock_.now() - *acknowledged_at_ > k_farewell;
}

wire::Counters Streamer::counters() const {
  const ScanCounts counts = scanner_.counts();
  wire::Counters counters;
  counters.frames = counts.frames;
  counters.frames_lost = counts.frames_lost;
  counters.frames_damaged = counts.frames_damaged;
  counters.poses = counts.poses;
  counters.poses_lost = counts.poses_lost;
  counters.poses_rejected = counts.poses_rejected;
  counters.profiles = counts.profiles;
  counters.profiles_dropped = counts.profiles_dropped;
  counters.overruns = counts.overruns;
  return counters;
}

std::vector<wire::StageTime> Streamer::stages() const {
  return {stage_time("wait_for_frame", scanner_.wait_meter), stage_time("frame_to_profile", scanner_.process_meter),
          stage_time("stamp_pose", scanner_.stamp_meter), stage_time("encode", encode_meter_)};
}

wire::Health Streamer::health() const {
  wire::Health health;
  health.counters = counters();
  health.stages = stages();
  health.scanning = !ended_;
  return health;
}

Result<void> Streamer::obey(wire::Command command) {
  switch (command) {
    case wire::Command::StopScan: scanner_.request_stop(); return {};
    case wire::Command::LaserOff:
    case wire::Command::StartScan: break;
  }
  return fail(Errc::NotSupported, "a recording has neither laser nor start button");
}

}  // namespace biteline::sensor
