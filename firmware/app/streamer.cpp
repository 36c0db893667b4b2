// SPDX-License-Identifier: MIT
#include "firmware/app/streamer.hpp"

#include <chrono>
#include <random>
#include <string>
#include <utility>

#include "common/stripe/peak_names.hpp"

namespace biteline::sensor {
namespace {

using std::chrono::milliseconds;

/// Longest sleep while nothing comes from the hosts: bounds what the network adds to a profile's age.
constexpr Nanoseconds k_idle_wait = milliseconds{1};
/// Between two looks at the network.
constexpr int k_profiles_per_turn = 16;
/// After the scan's end was acknowledged hosts have so long to say goodbye.
constexpr Nanoseconds k_farewell = milliseconds{500};
/// For the farewell itself to reach them, over loopback or a workshop's network.
constexpr Nanoseconds k_last_word = milliseconds{100};
/// From the start of a scan to its light: the first frames of a network camera take some tenths of a second.
constexpr Nanoseconds k_light_patience = milliseconds{5000};

/// A host that was killed comes back and goes on within that time; the laser does not shine on for nobody.
/// Begins when the server counts the last one as absent (2 s).
constexpr Nanoseconds k_host_patience = milliseconds{5000};

/// For the two looks of the laser's guard that follow the robot's end: 20 ms when all is well.
constexpr Nanoseconds k_looks_patience = milliseconds{1000};
/// The last scan's devices are closed before they are opened again; below the hosts' patience.
constexpr Nanoseconds k_close_patience = milliseconds{1500};
/// Recordings that are written at a time, the present one included; each has up to 130 MB of room.
constexpr std::size_t k_most_recorders = 3;

Errc code_of(runtime::LaserOff reason) {
  switch (reason) {
    case runtime::LaserOff::InterlockOpen:
    case runtime::LaserOff::KeyOff:
      return Errc::InterlockOpen;
    case runtime::LaserOff::FramesStopped:
      return Errc::Timeout;
    case runtime::LaserOff::WatchdogStarved:
    case runtime::LaserOff::StreamStarved:
    case runtime::LaserOff::SafetyHung:
      return Errc::Overrun;
    case runtime::LaserOff::TooHot:
    case runtime::LaserOff::DriverFailed:
    case runtime::LaserOff::NotAsked:
    case runtime::LaserOff::Stopped:
      break;
  }
  return Errc::DeviceError;
}

std::uint64_t random_scan_id() {
  std::random_device source;
  // 0 means no scan.
  return ((std::uint64_t{source()} << 32U) | source()) | 1U;
}

wire::SensorHello identity_of(const StreamerConfig& config, const SourceKind& kind) {
  wire::SensorHello hello;
  hello.name = config.name;
  hello.version = config.version;
  hello.lossless = kind.recording;
  hello.simulated = kind.simulated;
  hello.model = kind.model;
  hello.camera_state = kind.camera_state;
  return hello;
}

/// What a recording says of its head: its pictures were taken in the state that the camera told.
geometry::SensorModel as_seen(const SourceKind& kind) {
  geometry::SensorModel model = kind.model;
  model.camera_state = geometry::put_over(model.camera_state, kind.camera_state);
  return model;
}

}  // namespace

Streamer::Streamer(const StreamerConfig& config, SourceKind& kind, stream::StreamSocket& socket,
                   const hal::Clock& clock, runtime::LaserWatch* laser)
    : config_{config},
      kind_{kind},
      socket_{socket},
      clock_{clock},
      laser_{laser},
      server_{config.server, identity_of(config, kind), socket,
              [this](wire::Command command) { return obey(command); }, [this] { return health(); }},
      settings_{kind, config_.pipeline, config.told},
      record_turn_{config.record_every},
      keep_request_{{.series = config.record, .asked = config.record_asked, .realtime = config.realtime}},
      picture_maker_{config.realtime} {
  server_.take_settings_by([this](const std::string& text) { return use_settings(text); });
  server_.keep_recordings_by([this](wire::Command command) { return keep_scan(command); });
}

Result<void> Streamer::wait_for_closing() {
  if (closing_.valid() && closing_.wait_for(k_close_patience) != std::future_status::ready) {
    return fail(Errc::WrongState, "the camera or another device of the last scan does not answer yet");
  }
  return {};
}

Result<void> Streamer::start_scan() {
  if (state_ != State::Idle) return fail(Errc::WrongState, "a scan is on");
  BITELINE_TRY(wait_for_closing());
  BITELINE_ASSIGN(Source source, kind_.open());
  settings_.refresh();
  const std::string scan_name = source.scan_name;
  const std::uint64_t frames_expected = source.frames_expected;
  BITELINE_ASSIGN(std::unique_ptr<Scanner> scanner, Scanner::create(std::move(source),
                                                                    {.pipeline = config_.pipeline,
                                                                     .model = kind_.model,
                                                                     .capture = kind_.capture,
                                                                     .lossless = kind_.recording,
                                                                     .realtime = config_.realtime},
                                                                    clock_, laser_));
  // A replay of made pictures would be a scan of nothing.
  if (config_.record && !kind_.capture.test_pattern && record_turn_.due()) {
    BITELINE_TRY(begin_recording());
    scanner->record_into(recorders_.back()->tap());
  }
  if (Result<void> started = scanner->start(); !started) {
    if (std::exchange(recording_, false)) {
      recorders_.back()->discard();
      recorders_.pop_back();
    }
    close(std::move(scanner));
    return started;
  }
  // Only now: a scan that never began is not the one to record.
  test_pattern_ = kind_.capture.test_pattern;
  if (!test_pattern_) record_turn_.pass();
  scanner_ = std::move(scanner);
  server_.set_model(kind_.model);
  server_.set_test_pattern(test_pattern_);
  server_.set_camera_state(kind_.camera_state);
  server_.begin_scan(random_scan_id(), scan_name, frames_expected);
  if (recording_) recorders_.back()->keep_message(server_.hello_message());
  failure_.reset();
  robot_was_active_ = false;
  robots_end_.reset();
  state_ = State::Scanning;
  lit_ = false;
  light_asked_at_ = host_seen_at_ = clock_.now();
  if (laser_ != nullptr && !test_pattern_) laser_->ask_for_light(true);
  return {};
}

Result<void> Streamer::begin_recording() {
  std::erase_if(recorders_, [](const auto& recorder) { return recorder->done(); });
  if (recorders_.size() >= k_most_recorders) {
    return fail(Errc::WrongState, "%s: the disk still writes earlier scans", config_.record->c_str());
  }
  const stripe::PeakConfig& peaks = config_.pipeline.peaks;
  std::weak_ptr<const record::SessionRecorder> before;
  if (!recorders_.empty()) before = recorders_.back();
  BITELINE_ASSIGN(
      std::unique_ptr<record::SessionRecorder> recorder,
      record::SessionRecorder::begin(
          {.path = record::free_name(config_.record_asked ? record::waiting_name(*config_.record)
                                                          : *config_.record),
           .model = as_seen(kind_),
           .facts = {.sensor = config_.name,
                     .version = config_.version,
                     .peak_mode = stripe::name_of(stripe::k_peak_modes, peaks.mode),
                     .peak_choice = stripe::name_of(stripe::k_peak_choices, config_.pipeline.selector.choice),
                     .peak_threshold_grey = static_cast<double>(peaks.threshold_grey),
                     .peak_width_min_px = static_cast<double>(peaks.width_min_px),
                     .peak_width_max_px = static_cast<double>(peaks.width_max_px),
                     .second_exposures = kind_.capture.second_exposure.count() != 0,
                     .laser_off_frames = kind_.capture.laser_off_frames,
                     .pictures_every = config_.record_pictures_every},
           .settings = settings_.state().text,
           .series = *config_.record,
           .keep_bytes = config_.record_keep_bytes,
           .waits = config_.record_asked,
           .before = before,
           .realtime = config_.realtime}));
  recorders_.push_back(std::move(recorder));
  recording_ = true;
  return {};
}

void Streamer::run(const std::atomic<bool>& stop) {
  const stream::StreamSocket::Sink on_packet = [&](const stream::PeerId& peer,
                                                   std::span<const std::uint8_t> packet) {
    server_.on_packet(peer, packet, clock_.now());
  };
  picture_maker_.start();
  bool more_to_take = false;
  while (!stop && !delivered()) {
    if (laser_ != nullptr) laser_->note_stream(clock_.now());
    // Never again at once while a profile only waits for its poses: a real-time thread that spins leaves the
    // ordinary ones of its processor nothing, and what the kernel then gives them by force is 50 ms at a
    // time.
    const int refused = socket_.receive(more_to_take ? Nanoseconds{0} : k_idle_wait, on_packet);
    for (int i = 0; i < refused; ++i) server_.count_refused_peer();
    more_to_take = false;
    if (state_ != State::Idle) {
      follow_robot();
      watch_light();
      watch_hosts();
      more_to_take = take_profiles();
      answer_settings();
      if (scanner_->finished()) announce_end();
    }
    answer_keep();
    serve_pictures();
    server_.tick(clock_.now());
  }
  if (laser_ != nullptr) laser_->ask_for_light(false);
  server_.say_bye(stop ? "the sensor was told to stop" : "the scan is over");
  // A socket closed on unread packets resets its connection, and the farewell would be lost with it.
  const SensorClock::time_point last_word = clock_.now() + k_last_word;
  while (server_.hosts_present() > 0 && clock_.now() < last_word)
    (void)socket_.receive(k_idle_wait, on_packet);
}

void Streamer::follow_robot() {
  if (state_ != State::Scanning || scanner_->source().scan_active == nullptr) return;
  const Result<bool> active = scanner_->source().scan_active->level();
  // A line that cannot be read ends nothing: the host still can, and the poses show whether the arm moves.
  if (!active) return;
  if (robot_was_active_ && !*active && !robots_end_) {
    robots_end_ = RobotsEnd{.seen_at = clock_.now(), .looks = laser_ == nullptr ? 0 : laser_->status().looks};
  }
  robot_was_active_ = *active;
  if (robots_end_) judge_robots_end();
}

void Streamer::judge_robots_end() {
  if (laser_ == nullptr) return end_scan();
  // The look that was going on when the line fell may have read the inputs before.
  constexpr std::uint64_t k_looks = 2;
  if (laser_->status().looks < robots_end_->looks + k_looks) {
    if (clock_.now() - robots_end_->seen_at <= k_looks_patience) return;
    return fail_scan(fail(Errc::Overrun, "the laser's guard did not look again at the scan's end").value());
  }
  watch_light();
  if (state_ != State::Scanning) return;
  // The guard ends a scan whose camera is silent.  Where this whole program stood still it saw nothing, and
  // the time without exposures tells it all the same; twice, for frames that were only processed late.
  const Nanoseconds pause = scanner_->longest_pause(robots_end_->seen_at);
  if (pause > 2 * laser_->frames_within()) {
    return fail_scan(fail(Errc::Timeout, "the camera gave no frames for %lld ms",
                          static_cast<long long>(pause.count() / 1'000'000))
                         .value());
  }
  end_scan();
}

void Streamer::watch_light() {
  if (state_ != State::Scanning || laser_ == nullptr || test_pattern_) return;
  const runtime::LaserWatch::Status laser = laser_->status();
  lit_ = lit_ || laser.on;
  if (laser.on) return;
  const bool went_off = lit_ || laser.state == runtime::LaserGuard::State::Latched;
  if (!went_off && clock_.now() - light_asked_at_ < k_light_patience) return;
  fail_scan(fail(code_of(laser.reason), "the laser %s: %s", went_off ? "went off" : "stays off",
                 runtime::text(laser.reason))
                .value());
}

void Streamer::watch_hosts() {
  if (state_ != State::Scanning || laser_ == nullptr) return;
  const SensorClock::time_point now = clock_.now();
  if (server_.hosts_taking() > 0) host_seen_at_ = now;
  if (now - host_seen_at_ <= k_host_patience) return;
  fail_scan(fail(Errc::ConnectionLost, "no host for %lld s",
                 static_cast<long long>(k_host_patience.count() / 1'000'000'000))
                .value());
}

void Streamer::fail_scan(const Error& why) {
  failure_ = why;
  end_scan();
}

bool Streamer::take_profiles() {
  for (int i = 0; i < k_profiles_per_turn; ++i) {
    if (kind_.recording && !server_.has_room()) return false;
    const profile::ProfileBuffer* profile = scanner_->take();
    if (profile == nullptr) return false;
    const SensorClock::time_point begin = clock_.now();
    server_.add_profile(profile->header, profile->view());
    if (recording_) recorders_.back()->keep_message(server_.newest_message());
    encode_meter_.rt_add(clock_.now() - begin);
    scanner_->give_back();
  }
  return true;
}

void Streamer::serve_pictures() {
  const std::shared_ptr<pipeline::PictureTap> tap = scanner_ ? scanner_->pictures() : nullptr;
  const std::uint64_t wishes = server_.observers().wishes_version();
  if (tap != pictures_ordered_of_ || wishes != wishes_ordered_) {
    if (!picture_maker_.try_order(
            {.tap = tap, .scan_id = server_.scan_id(), .wishes = server_.observers().picture_wishes()}))
      return;
    pictures_ordered_of_ = tap;
    wishes_ordered_ = wishes;
  }
  for (const stream::MadePicture& picture : picture_maker_.try_take()) server_.add_picture(picture);
}

void Streamer::end_scan() {
  state_ = State::Ending;
  if (laser_ != nullptr) laser_->ask_for_light(false);
  scanner_->request_stop();
}

void Streamer::announce_end() {
  if (state_ == State::Scanning) end_scan();
  answer_settings();
  wire::EndOfScan end;
  // A device's own failure explains a laser that went off, and not the other way round.
  if (scanner_->failure()) failure_ = scanner_->failure();
  if (failure_) {
    end.errc = static_cast<std::uint16_t>(failure_->code);
    end.where = failure_->where.c_str();
  }
  end.counters = counters();
  end.stages = stages();
  end.devices = devices();
  last_end_ = end;
  server_.add_end(std::move(end));
  if (recording_) recorders_.back()->keep_message(server_.newest_message());
  frames_before_ += last_end_.counters.frames;
  // Only now: the devices' own counts are part of the above.
  close(std::move(scanner_));
  state_ = State::Idle;
  ended_once_ = true;
}

void Streamer::close(std::unique_ptr<Scanner> scanner) {
  std::shared_ptr<record::SessionRecorder> recorder;
  if (std::exchange(recording_, false)) recorder = recorders_.back();
  closing_ = std::async(std::launch::async,
                        [scanner = std::move(scanner), recorder = std::move(recorder)]() mutable {
                          const std::uint64_t unrepeatable = scanner->unrepeatable();
                          scanner.reset();
                          // Its threads are over: nothing more comes.
                          if (recorder) recorder->request_finish(unrepeatable);
                        });
}

bool Streamer::delivered() {
  if (!config_.leave_after_scan || !ended_once_) return false;
  if (!acknowledged_at_ && server_.end_acknowledged()) acknowledged_at_ = clock_.now();
  if (!acknowledged_at_) return false;
  return server_.hosts_present() == 0 || clock_.now() - *acknowledged_at_ > k_farewell;
}

Result<void> Streamer::obey(wire::Command command) {
  switch (command) {
    case wire::Command::StartScan:
      if (kind_.recording) return fail(Errc::NotSupported, "a recording plays by itself");
      return start_scan();
    case wire::Command::LaserOff:
      if (laser_ == nullptr) return fail(Errc::NotSupported, "there is no laser");
      laser_->ask_for_light(false);
      if (state_ == State::Scanning)
        fail_scan(fail(Errc::PeerRefused, "the laser went off: a host asked for it").value());
      return {};
    case wire::Command::UseSettings:
      return fail(Errc::ProtocolError, "settings without a set");
    case wire::Command::KeepLast:
    case wire::Command::KeepNext:
      return keep_scan(command);
    case wire::Command::StopScan:
      break;
  }
  if (state_ == State::Idle) return fail(Errc::WrongState, "no scan is on");
  end_scan();
  return {};
}

std::optional<Result<void>> Streamer::use_settings(const std::string& text) {
  if (kind_.recording) return fail(Errc::NotSupported, "a recording is exposed already");
  if (state_ == State::Ending) return fail(Errc::WrongState, "the scan is ending; send the settings again");
  if (state_ == State::Scanning) {
    // A replay has one way to find peaks for all of it.
    if (recording_) return fail(Errc::WrongState, "a recording is on: its settings stand until it ends");
    if (Result<void> offered = settings_.offer(text, *scanner_); !offered) return offered;
    return std::nullopt;
  }
  Result<void> done = wait_for_closing();
  if (done) done = settings_.use(text);
  // Hosts may still fetch the last scan: it keeps the head that it was made with.
  if (done && !ended_once_) server_.set_model(kind_.model);
  return done;
}

Result<void> Streamer::keep_scan(wire::Command command) {
  // Of the present scan's recorder nothing is known yet: the one before is meant.
  const std::size_t ended = recorders_.size() - (recording_ ? 1 : 0);
  record::LastScan last;
  if (ended > 0) {
    const record::SessionRecorder& recorder = *recorders_[ended - 1];
    last.being_written = !recorder.done();
    if (recorder.done()) last.fault = recorder.fault();
  }
  return keep_request_.begin(
      command == wire::Command::KeepLast ? record::KeepWhich::Last : record::KeepWhich::Next, last);
}

void Streamer::answer_keep() {
  if (const std::optional<Result<std::string>> kept = keep_request_.take()) server_.answer_keep(*kept);
}

void Streamer::answer_settings() {
  if (!settings_.offered()) return;
  const std::optional<Result<Scanner::Changed>> taken = scanner_->change_done();
  if (!taken) return;
  const Result<void> done = settings_.finish(*taken);
  if (done) server_.set_model(kind_.model);
  server_.answer_settings(done);
}

}  // namespace biteline::sensor
