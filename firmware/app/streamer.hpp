// SPDX-License-Identifier: MIT
#pragma once
/// \file The stream thread: begins and ends scans, and carries their profiles into the store and out to the
/// hosts.

#include <atomic>
#include <cmath>
#include <filesystem>
#include <future>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "common/rt/latest_value.hpp"
#include "firmware/app/picture_maker.hpp"
#include "firmware/app/scanner.hpp"
#include "firmware/app/settings_control.hpp"
#include "firmware/record/keep_request.hpp"
#include "firmware/record/session_recorder.hpp"
#include "firmware/record/wanted.hpp"
#include "firmware/stream/stream_socket.hpp"

namespace biteline::sensor {

struct StreamerConfig {
  stream::ServerConfig server;
  pipeline::ProfilePipeline::Config pipeline;
  runtime::RealtimeDemand realtime{runtime::RealtimeDemand::Required};
  std::string name{"biteline-sensor"};
  std::string version;
  Told told;                                    ///< stays above the settings that hosts send
  std::optional<std::filesystem::path> record;  ///< a session folder for each scan; none: nothing is kept
  std::uint32_t record_pictures_every{1};       ///< 0: none
  std::uint64_t record_keep_bytes{0};           ///< of all recordings of that name; 0: all stay
  std::uint32_t record_every{1};                ///< the first of so many scans
  bool record_asked{false};                     ///< scans wait until somebody asks for them
  bool leave_after_scan{false};  ///< once the scan's end was acknowledged: a recording is played once
};

/// | state    | StartScan | StopScan | robot's scan line falls    | source ends or fails |
/// |----------|-----------|----------|----------------------------|----------------------|
/// | Idle     | Scanning  | refused  | Idle                       | -                    |
/// | Scanning | refused   | Ending   | Ending, two looks later    | Ending               |
/// | Ending   | refused   | Ending   | Ending                  | Ending; Idle when the last profile is stored
/// |
///
/// refused: Errc::WrongState, to the host that asked.  Light is asked for in Scanning only (the laser's guard
/// decides); a laser that goes off meanwhile, or never comes on, ends the scan as failed, with the guard's
/// reason.  A robot that stops may do so for want of light or for what darkens the laser next: only after a
/// look of the laser's guard that began later, and without a pause of the frames, has it come to its scan's
/// end.  So does the absence of every host: what was scanned stays in the store for the one that comes back.
/// Runs on its caller's thread, which also opens the devices of a scan (some hundred ms on a network camera:
/// the hosts' patience is 2 s).  They are closed on a thread of their own.
class Streamer {
 public:
  Streamer(const StreamerConfig& config, SourceKind& kind, stream::StreamSocket& socket,
           const hal::Clock& clock, runtime::LaserWatch* laser);

  /// As a host's StartScan.
  [[nodiscard]] Result<void> start_scan();

  /// Until `stop` is set, or the scan is over and delivered (leave_after_scan).  Says goodbye to the hosts.
  void run(const std::atomic<bool>& stop);

  /// What ended the last scan, if it was not its own end.
  [[nodiscard]] std::optional<Error> failure() const { return failure_; }

  /// Frames of all scans since the start, a quarter of a second late.  Any thread.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }

  /// What the head's camera said last while a scan was on; nothing: none has.  Any thread.
  [[nodiscard]] std::optional<double> head_degc() const {
    const double now = head_degc_;
    return std::isfinite(now) ? std::optional{now} : std::nullopt;
  }

  /// What the unit has been through, told on in the health.  One thread, any.
  void note_upkeep(const wire::UpkeepState& upkeep) { upkeep_.rt_store(upkeep); }

 private:
  enum class State { Idle, Scanning, Ending };

  void follow_robot();
  void judge_robots_end();
  void watch_light();
  void watch_hosts();
  void fail_scan(const Error& why);
  [[nodiscard]] Result<void> begin_recording();
  /// True: more may be ready already.
  [[nodiscard]] bool take_profiles();
  void serve_pictures();
  void end_scan();
  void announce_end();
  void close(std::unique_ptr<Scanner> scanner);
  [[nodiscard]] bool delivered();
  [[nodiscard]] wire::Counters counters() const;
  [[nodiscard]] std::vector<wire::StageTime> stages() const;
  [[nodiscard]] wire::Devices devices() const;
  [[nodiscard]] wire::Health health() const;
  [[nodiscard]] Result<void> obey(wire::Command command);
  /// Nothing: the running scan takes them first.
  [[nodiscard]] std::optional<Result<void>> use_settings(const std::string& text);
  void answer_settings();
  [[nodiscard]] Result<void> keep_scan(wire::Command command);
  void answer_keep();
  [[nodiscard]] Result<void> wait_for_closing();

  StreamerConfig config_;
  SourceKind& kind_;
  stream::StreamSocket& socket_;
  const hal::Clock& clock_;
  runtime::LaserWatch* laser_;
  stream::StreamServer server_;
  SettingsControl settings_;
  State state_{State::Idle};
  /// Of the present scan and of earlier ones that are still being written; the present one is the last.
  std::vector<std::shared_ptr<record::SessionRecorder>> recorders_;
  bool recording_{false};  ///< the present scan is being recorded
  record::EveryNth record_turn_;
  record::KeepRequest keep_request_;
  std::unique_ptr<Scanner> scanner_;  ///< of the present scan; nothing while Idle
  wire::EndOfScan last_end_;          ///< the last scan's counts, told on while Idle
  PictureMaker picture_maker_;
  std::shared_ptr<pipeline::PictureTap> pictures_ordered_of_;
  std::uint64_t wishes_ordered_{0};  ///< version of them
  std::future<void> closing_;  ///< the last scan's devices: one that is gone takes seconds to be let go of
  runtime::StageMeter encode_meter_;
  std::optional<Error> failure_;
  mutable std::atomic<double> head_degc_{std::numeric_limits<double>::quiet_NaN()};
  mutable std::atomic<std::uint64_t> frames_{0};
  std::uint64_t frames_before_{0};  ///< of the scans that are over
  rt::LatestValue<wire::UpkeepState> upkeep_;
  mutable std::optional<wire::UpkeepState> upkeep_told_{};
  SensorClock::time_point light_asked_at_;
  SensorClock::time_point host_seen_at_;
  bool lit_{false};
  bool test_pattern_{false};  ///< the present or last scan's pictures are made: it has no light
  bool robot_was_active_{false};
  struct RobotsEnd {
    SensorClock::time_point seen_at;
    std::uint64_t looks;  ///< of the laser's guard, by then
  };
  std::optional<RobotsEnd> robots_end_;  ///< it stopped; not yet known why
  bool ended_once_{false};
  std::optional<SensorClock::time_point> acknowledged_at_;
};

}  // namespace biteline::sensor
