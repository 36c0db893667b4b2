// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/sensor_watch.hpp"

#include <pthread.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/wire/observer.hpp"
#include "host/apps/biteline-web/profile_curvature.hpp"
#include "host/apps/biteline-web/routes.hpp"
#include "host/apps/biteline-web/sensor_state.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::web {

LiveBytes CloudPieces::add(std::uint64_t scan, const profile::Profile& profile) {
  if (!T_flange_cam_) return nullptr;
  if (scan != scan_) {
    scan_ = scan;
    profiles_ = 0;
    points_.clear();
  }
  if ((profile.header.flags & profile::k_profile_not_usable) == 0) {
    const SE3 T_base_cam = profile.header.T_base_flange * *T_flange_cam_;
    const std::size_t step = 1 + profile.points.size() / k_points_a_profile;
    const std::vector<float> curvature = profile_curvature(profile.points);
    for (std::size_t i = 0; i < profile.points.size(); i += step) {
      const profile::ProfilePoint& point = profile.points[i];
      if ((point.flags & profile::k_point_not_surface) != 0) continue;
      points_.push_back({.point_base = (T_base_cam * point.point_cam.cast<double>()).cast<float>(),
                         .curvature_per_mm = curvature[i],
                         .sigma_mm = point.sigma_mm});
    }
  }
  if (++profiles_ < k_profiles_a_piece || points_.empty()) return nullptr;
  LiveBytes piece = cloud_message(static_cast<std::uint32_t>(scan), points_);
  points_.clear();
  profiles_ = 0;
  return piece;
}

struct SensorWatch::State {
  SensorWatchConfig config;
  LiveSink sink;
  CloudPieces pieces;
  std::uint64_t scan{0};
  std::optional<wire::SensorHello> known;  ///< of this connection or the one before

  std::mutex mutex;
  std::condition_variable changed;
  std::optional<wire::Endpoint> sensor;       ///< guarded
  std::filesystem::path results;              ///< guarded
  std::optional<std::filesystem::path> line;  ///< guarded: a line.csv that is to be shown
  std::atomic<bool> stop{false};
  std::thread thread;

  void run();
  /// Until the link is over or another sensor is named.
  void watch(const wire::Endpoint& endpoint);
  void show(const wire::Message& message);
  void show_line();
  void wait_a_second();
};

void SensorWatch::State::run() {
  pthread_setname_np(pthread_self(), "bl-watch");
  while (!stop) {
    std::optional<wire::Endpoint> endpoint;
    {
      const std::lock_guard lock{mutex};
      endpoint = sensor;
    }
    if (endpoint) watch(*endpoint);
    show_line();
    wait_a_second();
  }
}

void SensorWatch::State::wait_a_second() {
  std::unique_lock lock{mutex};
  changed.wait_for(lock, std::chrono::seconds{1}, [this] { return stop || line; });
}

void SensorWatch::State::watch(const wire::Endpoint& endpoint) {
  using std::chrono::milliseconds;
  bool wished = false;
  wire::ObserverConfig watched{.sensor = endpoint, .keys = config.keys, .wish = {}};
  watched.wish.name = "biteline-web";
  const auto observer = wire::Observer::open(watched);
  if (!observer) return;
  while (!stop) {
    // Nobody looks: the sensor need not make pictures.
    const bool wanted = sink.watchers() > 0;
    if (wanted != wished) {
      wished = wanted;
      (*observer)->wish_for(
          {.rate_hz = wanted ? config.picture_rate_hz : 0, .width_max_px = config.picture_width_max_px});
      (*observer)->wish_for_profiles(wanted ? config.profile_rate_hz : 0);
    }
    const auto message = (*observer)->next(milliseconds{100});
    if (!message) return;
    if (*message) show(**message);
    show_line();
    const std::lock_guard lock{mutex};
    if (!sensor || sensor->text() != endpoint.text()) return;
  }
}

void SensorWatch::State::show(const wire::Message& message) {
  if (message.scan_id != scan) {
    scan = message.scan_id;
    sink.forget_scan();
  }
  if (const auto* hello = std::get_if<wire::SensorHello>(&message.body)) {
    pieces.begin(hello->model);
    known = *hello;
  } else if (const auto* health = std::get_if<wire::Health>(&message.body)) {
    if (known && sink.watchers() > 0)
      sink.publish(LiveKind::Sensor, sensor_message(sensor_state(*known, *health)));
  } else if (const auto* profile = std::get_if<profile::Profile>(&message.body)) {
    sink.publish(LiveKind::Profile, profile_message(*profile));
    if (LiveBytes piece = pieces.add(message.scan_id, *profile))
      sink.publish(LiveKind::Cloud, std::move(piece));
  } else if (const auto* picture = std::get_if<wire::Picture>(&message.body)) {
    const LiveStamp stamp{
        .sequence = static_cast<std::uint32_t>(picture->frame_sequence),
        .time_ns = static_cast<std::uint64_t>(picture->exposure_mid.time_since_epoch().count())};
    if (picture->format == wire::PictureFormat::Jpeg) {
      sink.publish(LiveKind::Peaks, peaks_message(*picture));
      sink.publish(LiveKind::Picture, picture_message(stamp, picture->pixels));
    }
  }
}

void SensorWatch::State::show_line() {
  std::optional<std::filesystem::path> file;
  {
    const std::lock_guard lock{mutex};
    file.swap(line);
  }
  if (!file) return;
  // A line that cannot be read is told by the service; here there is just nothing to show.
  if (const auto read = cloud::read_line(*file)) sink.publish(LiveKind::Line, line_message(*read));
}

SensorWatch::SensorWatch(const SensorWatchConfig& config, LiveSink sink) : state_{std::make_unique<State>()} {
  state_->config = config;
  state_->sink = std::move(sink);
  state_->sensor = config.sensor;
  state_->thread = std::thread{[state = state_.get()] { state->run(); }};
}

SensorWatch::~SensorWatch() {
  state_->stop = true;
  state_->changed.notify_all();
  state_->thread.join();
}

void SensorWatch::hear(const control::Event& event) {
  const auto text_of = [&event](const char* field) -> std::string {
    const auto found = event.data.is_object() ? event.data.find(field) : event.data.end();
    return found != event.data.end() && found->is_string() ? found->get<std::string>() : std::string{};
  };
  const std::lock_guard lock{state_->mutex};
  if (event.name == "hello") {
    state_->results = text_of("results");
    const auto named = wire::parse_endpoint(text_of("sensor"));
    if (named && !state_->config.sensor) state_->sensor = *named;
  } else if (event.name == "scan") {
    const std::string scan = text_of("id");
    const std::string verdict = text_of("verdict");
    if (!is_scan_name(scan) || state_->results.empty() || (verdict != "ok" && verdict != "amber")) return;
    state_->line = state_->results / scan / "line.csv";
    state_->changed.notify_all();
  }
}

}  // namespace biteline::web
