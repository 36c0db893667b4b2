// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/feed.hpp"

#include <memory>
#include <thread>

#include "common/wire/observer.hpp"
#include "host/intake/sensor_link.hpp"
#include "host/interfaces/gige/depth.hpp"
#include "host/interfaces/gige/exposure.hpp"

namespace biteline::gige {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds k_turn{50};
constexpr milliseconds k_before_retry{500};
/// A scan before it ends, and the arm goes back: a start is asked for again within this.
constexpr std::chrono::seconds k_ask_patience{10};
/// All of them, as fast as any sensor scans.
constexpr double k_every_profile_hz = 10'000;
constexpr const char* k_name = "biteline-gige";

/// Tells the face the exposure whenever it changed; a health comes four times a second.
class ExposureWatch {
 public:
  explicit ExposureWatch(Server& server) : server_{server} {}
  void hear(const wire::SensorHello& hello) { tell(exposure_of(hello)); }
  void hear(const wire::Health& health) { tell(exposure_of(health, told_)); }

 private:
  void tell(Nanoseconds exposure) {
    told_ = exposure;
    server_.set_exposure(exposure);
  }

  Server& server_;
  Nanoseconds told_{0};
};

void show_head(Server& server, const geometry::SensorModel& model) {
  server.set_head(static_cast<std::size_t>(model.region.width_px), depth_of(model),
                  picture_shape(model.region));
}

/// Pictures go to observers alone: one of its own, beside the host that has the scan.
class PictureWatch {
 public:
  PictureWatch(const FeedConfig& config, Server& server) : config_{config}, server_{server} {}

  /// Offers what came, as long as a client acquires pictures.
  Result<void> turn() {
    if (!server_.wants_pictures()) {
      observer_.reset();
      return {};
    }
    if (!observer_) {
      wire::ObserverConfig watched{.sensor = config_.sensor, .keys = config_.keys, .wish = {}};
      watched.wish.name = k_name;
      BITELINE_ASSIGN(observer_, wire::Observer::open(watched));
    }
    while (true) {
      BITELINE_ASSIGN(const auto message, observer_->next(Nanoseconds{0}));
      if (!message) return {};
      if (const auto* hello = std::get_if<wire::SensorHello>(&message->body))
        observer_->wish_for(wish_for(picture_shape(hello->model.region)));
      if (const auto* picture = std::get_if<wire::Picture>(&message->body))
        server_.offer(message->scan_id, *picture);
    }
  }

 private:
  const FeedConfig& config_;
  Server& server_;
  std::unique_ptr<wire::Observer> observer_;
};

/// A scan of this program's own, from its first profile to its end.
class OwnScan {
 public:
  OwnScan(Server& server, intake::SensorLink& link) : server_{server}, link_{link}, exposure_{server} {}

  Result<void> take(const intake::LinkEvent& event) {
    if (const auto* hello = std::get_if<intake::Hello>(&event)) return begin(*hello);
    if (const auto* reply = std::get_if<wire::ControlReply>(&event)) {
      unanswered_ = false;
      if (reply->errc == 0) return {};
      return fail(Errc::PeerRefused, "the sensor refuses a scan: %s", reply->where.c_str());
    }
    if (const auto* health = std::get_if<wire::Health>(&event)) exposure_.hear(*health);
    if (!wanted_) return {};
    if (const auto* profile = std::get_if<intake::ProfileEvent>(&event))
      server_.offer(scan_, profile->profile);
    if (std::holds_alternative<wire::EndOfScan>(event)) {
      server_.end_scan();
      on_ = false;
    }
    return {};
  }
  /// It was asked for, and the sensor has not said yet whether it takes place.
  [[nodiscard]] bool unanswered() const { return unanswered_; }
  /// It has not ended as far as is known.
  [[nodiscard]] bool on() const { return on_; }

 private:
  Result<void> begin(const intake::Hello& hello) {
    show_head(server_, hello.sensor.model);
    exposure_.hear(hello.sensor);
    // A recording plays by itself; of a live sensor what it holds of earlier scans is not this client's.
    wanted_ = hello.sensor.lossless || (asked_ && hello.scan_id != scan_before_);
    scan_ = hello.scan_id;
    if (hello.sensor.lossless) on_ = true;
    if (wanted_ || asked_) return {};
    asked_ = unanswered_ = on_ = true;
    scan_before_ = hello.scan_id;
    link_.command({.id = 1, .command = wire::Command::StartScan});
    return {};
  }

  Server& server_;
  intake::SensorLink& link_;
  ExposureWatch exposure_;
  bool asked_{false}, wanted_{false}, unanswered_{false}, on_{false};
  std::uint64_t scan_{0}, scan_before_{0};
};

}  // namespace

Feed::Feed(FeedConfig config, Server& server, std::function<void(const std::string&)> say)
    : config_{std::move(config)}, server_{server}, say_{std::move(say)} {}

void Feed::run(const std::atomic<bool>& stop) {
  std::uint64_t asked = 0;  // the start for which the sensor was asked last
  Clock::time_point ask_until{};
  while (!stop) {
    const bool own = config_.allow_control && server_.acquiring();
    if (own && asked != server_.starts()) {
      asked = server_.starts();
      ask_until = Clock::now() + k_ask_patience;
    } else if (own && Clock::now() > ask_until) {
      // Light that a client did not get when it asked does not come later by itself.
      std::this_thread::sleep_for(k_turn);
      continue;
    }
    if (const Result<void> done = own ? own_scan(stop) : observe(stop); !done) {
      tell(done.error());
      server_.end_scan();
      const Clock::time_point again = Clock::now() + k_before_retry;
      while (!stop && Clock::now() < again) std::this_thread::sleep_for(k_turn);
    }
  }
}

void Feed::tell(const Error& error) {
  const std::string line = to_line(error);
  if (line == told_) return;
  told_ = line;
  say_(line);
}

Result<void> Feed::observe(const std::atomic<bool>& stop) {
  wire::ObserverConfig watched{.sensor = config_.sensor, .keys = config_.keys, .wish = {}};
  watched.wish.name = k_name;
  BITELINE_ASSIGN(const auto observer, wire::Observer::open(watched));
  bool wished = false;
  PictureWatch pictures{config_, server_};
  ExposureWatch exposure{server_};
  while (!stop) {
    if (server_.acquiring() && config_.allow_control) return {};
    BITELINE_TRY(pictures.turn());
    const bool wanted = server_.acquiring() && !server_.wants_pictures();
    if (wanted != wished) observer->wish_for_profiles(wanted ? k_every_profile_hz : 0);
    wished = wanted;
    BITELINE_ASSIGN(const auto message, observer->next(k_turn));
    if (!message) continue;
    told_.clear();
    if (const auto* hello = std::get_if<wire::SensorHello>(&message->body)) {
      show_head(server_, hello->model);
      exposure.hear(*hello);
    }
    if (const auto* health = std::get_if<wire::Health>(&message->body)) exposure.hear(*health);
    if (const auto* profile = std::get_if<profile::Profile>(&message->body))
      server_.offer(message->scan_id, *profile);
    if (std::holds_alternative<wire::EndOfScan>(message->body)) server_.end_scan();
  }
  return {};
}

Result<void> Feed::own_scan(const std::atomic<bool>& stop) {
  intake::SensorLinkConfig linked{.sensor = config_.sensor, .keys = config_.keys, .protocol = {}};
  linked.protocol.name = k_name;
  BITELINE_ASSIGN(const auto link, intake::SensorLink::open(linked));
  OwnScan scan{server_, *link};
  PictureWatch pictures{config_, server_};
  while (!stop && server_.acquiring()) {
    BITELINE_TRY(pictures.turn());
    BITELINE_ASSIGN(const auto event, link->next(k_turn));
    if (event) BITELINE_TRY(scan.take(*event));
  }
  // Another host's scan is not this client's to end: the answer tells whose it is.
  const Clock::time_point answered_by = Clock::now() + k_before_retry;
  while (scan.unanswered() && Clock::now() < answered_by) {
    BITELINE_ASSIGN(const auto event, link->next(k_turn));
    if (event) BITELINE_TRY(scan.take(*event));
  }
  if (!scan.on()) return {};
  link->command({.id = 2, .command = wire::Command::StopScan});
  // Until it is told, or the sensor is gone: without this host the guard turns the laser off by itself.
  const Clock::time_point end = Clock::now() + k_before_retry;
  while (Clock::now() < end) {
    BITELINE_ASSIGN(const auto event, link->next(k_turn));
    if (event && std::holds_alternative<wire::ControlReply>(*event)) break;
  }
  return {};
}

}  // namespace biteline::gige
