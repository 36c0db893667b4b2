// SPDX-License-Identifier: MIT
#include "host/intake/session_run.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "common/config/sensor_yaml.hpp"
#include "common/session/session.hpp"
#include "host/intake/sensor_link.hpp"
#include "host/intake/sensor_process.hpp"

namespace biteline::intake {
namespace {

using std::chrono::steady_clock;

/// Reading the tables and building the sensor's tables takes well below a second; a loaded machine gets more.
constexpr std::chrono::seconds k_start_limit{20};
constexpr Nanoseconds k_turn = std::chrono::milliseconds{100};

double seconds_since(steady_clock::time_point begin) {
  return std::chrono::duration<double>(steady_clock::now() - begin).count();
}

/// The sensor reads the same files again; read here first, so that a fault arrives as itself and not as a
/// dead child.
Result<void> check_input(const SessionRunOptions& options) {
  BITELINE_ASSIGN(const session::Session session, session::read_session(options.session));
  if (options.sensor_file) {
    BITELINE_ASSIGN(const geometry::SensorModel given, config::read_sensor_yaml(*options.sensor_file));
    BITELINE_TRY(geometry::expect_state(given.camera_state, session.sensor.camera_state));
  }
  return {};
}

Result<SensorProcess> start_sensor(const SessionRunOptions& options) {
  std::filesystem::path program;
  if (options.program) {
    program = *options.program;
  } else {
    BITELINE_ASSIGN(program, find_sensor_program());
  }
  std::vector<std::string> arguments{"--source", "replay:" + options.session.string()};
  if (options.sensor_file) {
    arguments.emplace_back("--sensor");
    arguments.push_back(options.sensor_file->string());
  }
  arguments.insert(arguments.end(), options.sensor_options.begin(), options.sensor_options.end());
  return SensorProcess::start(program, arguments, k_start_limit);
}

/// The sensor's own error, as it would have been told here.
Error error_of(const wire::EndOfScan& end) {
  const auto rows = error_table();
  const bool known = std::any_of(rows.begin(), rows.end(), [&](const ErrorRow& row) {
    return static_cast<std::uint16_t>(row.code) == end.errc;
  });
  return fail(known ? static_cast<Errc>(end.errc) : Errc::ProtocolError, "%s", end.where.c_str()).value();
}

Result<void> check_counts(const SessionRun& run) {
  const wire::Counters& sensor = run.sensor_counters;
  const std::uint64_t missing =
      run.link.lost + run.counts.profiles_lost + sensor.profiles_dropped + sensor.frames_lost;
  if (run.counts.profiles == sensor.profiles && sensor.profiles == run.sensor.frames_expected && missing == 0)
    return {};
  return fail(Errc::ProtocolError,
              "%llu frames recorded, %llu profiles made, %llu received: a replay must lose nothing",
              static_cast<unsigned long long>(run.sensor.frames_expected),
              static_cast<unsigned long long>(sensor.profiles),
              static_cast<unsigned long long>(run.counts.profiles));
}

/// One replay in progress.
class Intake {
 public:
  Intake(const SessionRunOptions& options, SensorProcess& process, SensorLink& link)
      : options_{options}, process_{process}, link_{link} {}

  Result<SessionRun> run() {
    const steady_clock::time_point begin = steady_clock::now();
    while (!ended_) {
      const Result<std::optional<LinkEvent>> event = link_.next(k_turn);
      // A dead sensor explains a broken link, and not the other way round.
      if ((!event || !*event) && !process_.child().running()) return tl::unexpected<Error>{process_.death()};
      if (!event) return tl::unexpected<Error>{event.error()};
      if (*event) {
        BITELINE_TRY(take(**event));
      }
    }
    run_.stream_s = seconds_since(begin);
    run_.link = link_.counters();
    run_.counts = builder_->counts();
    run_.cloud = builder_->take();
    BITELINE_TRY(check_counts(run_));
    return std::move(run_);
  }

 private:
  Result<void> take(const LinkEvent& event) {
    if (const auto* hello = std::get_if<Hello>(&event)) {
      if (hello->other_scan) return fail(Errc::ConnectionLost, "the sensor began another scan");
      run_.sensor = hello->sensor;
      builder_.emplace(hello->sensor.model);
    } else if (const auto* profile = std::get_if<ProfileEvent>(&event)) {
      const std::span<const Eigen::Vector3f> points = builder_->add(profile->profile);
      if (options_.on_profile) options_.on_profile(profile->profile, points, builder_->stripe_of_last());
      if (options_.progress) options_.progress(builder_->counts().profiles, run_.sensor.frames_expected);
    } else if (const auto* end = std::get_if<wire::EndOfScan>(&event)) {
      if (end->errc != 0) return tl::unexpected<Error>{error_of(*end)};
      run_.sensor_counters = end->counters;
      run_.sensor_stages = end->stages;
      ended_ = true;
    }
    return {};
  }

  const SessionRunOptions& options_;
  SensorProcess& process_;
  SensorLink& link_;
  SessionRun run_;
  std::optional<CloudBuilder> builder_;
  bool ended_{false};
};

}  // namespace

Result<SessionRun> run_sensor_on_session(const SessionRunOptions& options) {
  const steady_clock::time_point begin = steady_clock::now();
  BITELINE_TRY(check_input(options));
  BITELINE_ASSIGN(SensorProcess process, start_sensor(options));
  SensorLinkConfig config;
  config.sensor = process.endpoint();
  config.protocol.name = "biteline replay";
  BITELINE_ASSIGN(std::unique_ptr<SensorLink> link, SensorLink::open(config));
  const double start_s = seconds_since(begin);
  BITELINE_ASSIGN(SessionRun run, (Intake{options, process, *link}.run()));
  run.start_s = start_s;
  return run;
}

}  // namespace biteline::intake
