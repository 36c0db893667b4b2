// SPDX-License-Identifier: MIT
// biteline-sensor: picks the devices, wires the threads, and ends with one plain line and an exit status.
#include <sys/prctl.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <new>
#include <optional>
#include <string_view>
#include <thread>

#include "common/system/last_words.hpp"
#include "common/wire/keys.hpp"
#include "firmware/app/board_check.hpp"
#include "firmware/app/options.hpp"
#include "firmware/app/rate_check.hpp"
#include "firmware/app/stills.hpp"
#include "firmware/app/streamer.hpp"
#include "firmware/record/wanted.hpp"
#include "firmware/stream/stream_socket.hpp"
#include "firmware/upkeep/upkeep_keeper.hpp"

namespace {

using namespace biteline;

/// SIGTERM and SIGINT arrive at wait_for_signal() and nowhere else; a broken pipe is an error code, not a
/// death.
sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signals;
}

/// The kernel then tells us by SIGTERM when our parent dies.
void tie_to_parent() {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
}

void wait_for_signal(const sigset_t& signals, const std::atomic<bool>& stream_over, std::atomic<bool>& stop,
                     const std::function<void()>& turn = {}) {
  constexpr timespec k_look{.tv_sec = 0, .tv_nsec = 20'000'000};
  while (!stream_over) {
    if (sigtimedwait(&signals, nullptr, &k_look) > 0) stop = true;
    if (turn && !stop) turn();
  }
}

/// What the unit goes through, seen and written by the main thread.  A unit that cannot count works on.
class UnitCount {
 public:
  UnitCount(const std::optional<std::filesystem::path>& folder, const runtime::LaserWatch* laser,
            sensor::Streamer& streamer)
      : laser_{laser}, streamer_{streamer} {
    if (!folder) return;
    Result<upkeep::UpkeepKeeper> keeper = upkeep::UpkeepKeeper::open(*folder, upkeep::present_boot());
    if (keeper) {
      keeper_.emplace(std::move(*keeper));
    } else {
      log_error(keeper.error());
    }
  }

  void see() {
    if (!keeper_) return;
    const upkeep::Look look{.up_s = upkeep::since_boot_s(),
                            .laser_on = laser_ != nullptr && laser_->status().on,
                            .head_degc = streamer_.head_degc(),
                            .frames = streamer_.frames()};
    keeper_->see(look);
    streamer_.note_upkeep(figures(keeper_->upkeep()));
    if (keeper_->due()) write();
  }

  /// Pre: dark.
  void write() {
    if (!keeper_) return;
    if (const Result<void> written = keeper_->write(); !written) log_error(written.error());
  }

 private:
  static wire::UpkeepState figures(const upkeep::Upkeep& upkeep) {
    wire::UpkeepState state{.starts = upkeep.starts,
                            .boots = upkeep.boots,
                            .run_s = upkeep.run_s,
                            .laser_s = upkeep.laser_s,
                            .lightings = upkeep.lightings,
                            .frames = upkeep.frames,
                            .coldest_degc = {},
                            .hottest_degc = {}};
    if (upkeep.coldest_degc && upkeep.hottest_degc) {
      state.coldest_degc = static_cast<float>(*upkeep.coldest_degc);
      state.hottest_degc = static_cast<float>(*upkeep.hottest_degc);
    }
    return state;
  }

  static void log_error(const Error& error) {
    std::fprintf(stderr, "biteline-sensor: what the unit goes through is not counted: %s\n",
                 to_line(error).c_str());
  }

  const runtime::LaserWatch* laser_;
  sensor::Streamer& streamer_;
  std::optional<upkeep::UpkeepKeeper> keeper_;
};

Result<std::unique_ptr<stream::StreamSocket>> open_network(const sensor::Options& options,
                                                           runtime::RealtimeDemand demand) {
  stream::StreamSocket::Config network{.listen = options.listen, .keys = {}};
  if (options.keys) {
    BITELINE_ASSIGN(network.keys, wire::read_sensor_keys(*options.keys));
  }
  BITELINE_ASSIGN([[maybe_unused]] const auto lent,
                  runtime::LentPriority::lend(runtime::threads::k_network, demand));
  return stream::StreamSocket::open(std::move(network));
}

/// Dark from here on until a scan asks for light; nothing where there is no laser.
Result<std::unique_ptr<runtime::LaserWatch>> start_laser_watch(sensor::SourceKind& kind,
                                                               const hal::Clock& clock,
                                                               runtime::RealtimeDemand demand) {
  BITELINE_ASSIGN(std::optional<sensor::LaserDevices> devices, kind.open_laser());
  if (!devices) return std::unique_ptr<runtime::LaserWatch>{};
  auto watch = std::make_unique<runtime::LaserWatch>(std::move(devices->laser), std::move(devices->safety),
                                                     clock, devices->guard);
  for (std::unique_ptr<hal::Watchdog>& watchdog : devices->watchdogs) watch->feed(std::move(watchdog));
  BITELINE_TRY(watch->start(demand));
  return watch;
}

/// As a scan would, but dark; one line as check() has them.
Result<void> check_rate(const sensor::Options& options) {
  constexpr std::chrono::seconds k_duration{3};
  BITELINE_ASSIGN(const std::unique_ptr<sensor::SourceKind> kind, sensor::choose_source(options.source));
  if (kind->by_way) {
    std::printf("ready\trate\tan encoder asks for each frame: at rest there is no rate to measure\t\n");
    return {};
  }
  const runtime::RealtimeDemand demand = options.realtime.value_or(runtime::RealtimeDemand::Required);
  kind->realtime = demand == runtime::RealtimeDemand::Required;
  BITELINE_TRY(runtime::prepare_process(demand));
  BITELINE_TRY(runtime::enter_thread(runtime::threads::k_main, demand));
  const hal::MonotonicClock clock;
  // Nobody asks it for light: it holds the laser dark until this program ends.
  BITELINE_ASSIGN(const std::unique_ptr<runtime::LaserWatch> laser, start_laser_watch(*kind, clock, demand));
  sensor::Scanner::Config config{
      .pipeline = {}, .model = kind->model, .capture = kind->capture, .lossless = false, .realtime = demand};
  BITELINE_ASSIGN(config.pipeline, sensor::pipeline_config(options.peaks, std::nullopt));
  const Result<sensor::RateCheck> checked = sensor::check_rate(*kind, config, clock, k_duration);
  if (laser) laser->stop();
  if (!checked) return tl::unexpected<Error>{checked.error()};
  const bool blamed_on_poses = !checked->kept() && checked->poses_lacked();
  std::printf("%s\trate\t%.1f of %.1f profiles a second, %.1f %% late, %.1f %% lost%s\t%s\n",
              checked->kept() ? "ready" : "missing", checked->profiles_hz, checked->wanted_hz,
              100 * checked->late_ratio, 100 * checked->lost_ratio,
              checked->poses_lacked() ? "; no poses came" : "",
              checked->kept()   ? ""
              : blamed_on_poses ? "switch the robot's controller on and check its cable: without poses each "
                                  "profile waits, and no rate is told"
                                : "a lower rate, or fewer rows");
  if (checked->kept()) return {};
  if (blamed_on_poses) {
    return fail(Errc::PoseStale, "no poses: %.0f %% of the profiles have none, so no rate is told",
                100 * checked->no_pose_ratio);
  }
  return fail(Errc::Overrun, "%.1f of %.1f profiles a second, %.1f %% late, %.1f %% lost",
              checked->profiles_hz, checked->wanted_hz, 100 * checked->late_ratio, 100 * checked->lost_ratio);
}

/// One line for each device: ready or missing, what, what was seen, and the one step; tabs between.
Result<void> check(const sensor::Options& options) {
  constexpr std::string_view k_board = "board:";
  if (!options.source.source.starts_with(k_board)) {
    return fail(Errc::InvalidArgument, "--check: --source board:FILE expected");
  }
  BITELINE_ASSIGN(const std::vector<sensor::DeviceFinding> found,
                  sensor::check_board(options.source.source.substr(k_board.size()), options.source));
  int missing = 0;
  for (const sensor::DeviceFinding& device : found) {
    std::printf("%s\t%s\t%s\t%s\n", device.ready ? "ready" : "missing", device.what.c_str(),
                device.seen.c_str(), device.step.c_str());
    missing += device.ready ? 0 : 1;
  }
  // No device: what the unit has been through, where it is counted.
  if (const Result<upkeep::Upkeep> kept =
          upkeep::read_upkeep(options.upkeep.value_or("/var/lib/biteline") / upkeep::k_file))
    std::printf("ready\tthis unit\t%s\t\n", upkeep::in_words(*kept).c_str());
  if (missing > 0)
    return fail(Errc::DeviceNotFound, "%d of %zu devices and rights are missing", missing, found.size());
  return {};
}

/// Of a sensor that records beside: files tell it.
Result<void> keep_scan(const sensor::Options& options) {
  if (*options.keep == "next") {
    BITELINE_TRY(record::keep_next(*options.record));
    std::printf("the scan that ends next is kept\n");
    return {};
  }
  BITELINE_ASSIGN(const std::filesystem::path kept, record::keep_last(*options.record));
  std::printf("%s\n", kept.c_str());
  return {};
}

/// Until stdin ends or a signal comes; the laser is dark but for the pictures that want it.
Result<void> take_stills(const sensor::Options& options, const sigset_t& signals) {
  constexpr std::string_view k_board = "board:";
  if (!options.source.source.starts_with(k_board))
    return fail(Errc::InvalidArgument, "--stills: --source board:FILE expected");
  if (options.exit_with_parent) tie_to_parent();
  const runtime::RealtimeDemand demand = options.realtime.value_or(runtime::RealtimeDemand::Required);
  BITELINE_TRY(runtime::prepare_process(demand));
  BITELINE_TRY(runtime::enter_thread(runtime::threads::k_main, demand));
  BITELINE_ASSIGN(hal::Board board, hal::read_board_yaml(options.source.source.substr(k_board.size())));
  sensor::BoardDevices devices{std::move(board), {}};
  devices.realtime = demand == runtime::RealtimeDemand::Required;
  const hal::MonotonicClock clock;
  BITELINE_ASSIGN(const std::unique_ptr<runtime::LaserWatch> laser,
                  start_laser_watch(devices, clock, demand));
  BITELINE_ASSIGN(const std::unique_ptr<sensor::StillCamera> camera,
                  sensor::StillCamera::open(devices, clock, laser.get(), {.realtime = demand}));
  std::printf("{\"stills\":1}\n");
  std::fflush(stdout);
  std::atomic<bool> stop{false};
  std::atomic<bool> over{false};
  Result<void> served;
  std::thread frames{[&] {
    served = runtime::enter_thread(runtime::threads::k_acquisition, demand);
    if (served) served = sensor::serve_stills(*camera, stop);
    over = true;
  }};
  wait_for_signal(signals, over, stop);
  frames.join();
  if (laser) laser->stop();
  return served;
}

/// A calibration of before holds for a camera as it is usual, and that is looked at; what it does not tell is
/// not set, so that what another program set stays and is found.
void tell_untold_state(const sensor::SourceKind& kind) {
  if (kind.recording || kind.calibrated.camera_state.told()) return;
  std::fprintf(
      stderr,
      "biteline-sensor: %s tells no camera_state: neither mirror nor turn, binning nor skipped pixels "
      "are expected\n",
      kind.head_file.c_str());
}

/// A set that the camera does not take stops the program before anybody relies on it.  A camera that is not
/// there yet is told at the first scan.
Result<void> try_settings(sensor::SourceKind& kind) {
  const Result<void> tried = kind.try_settings();
  // A camera that another program turned refuses its scans by name, until it is set back: no end for a unit.
  const bool turned = !tried && tried.error().code == Errc::Refused;
  if (tried || (!turned && error_row(tried.error().code).exit_status != ExitStatus::Connection)) return tried;
  std::fprintf(stderr, "biteline-sensor: the settings are not tried yet: %s\n",
               to_line(tried.error()).c_str());
  return {};
}

Result<void> run(const sensor::Options& options, const sigset_t& signals) {
  if (options.exit_with_parent) tie_to_parent();
  BITELINE_ASSIGN(const std::unique_ptr<sensor::SourceKind> kind, sensor::choose_source(options.source));
  const runtime::RealtimeDemand demand = options.realtime.value_or(
      kind->recording ? runtime::RealtimeDemand::Ignored : runtime::RealtimeDemand::Required);
  if (kind->recording && options.record) {
    return fail(Errc::InvalidArgument, "--record: a live source expected, '%s' is a recording",
                options.source.source.c_str());
  }
  kind->realtime = demand == runtime::RealtimeDemand::Required;
  tell_untold_state(*kind);
  BITELINE_TRY(kind->expect_lit_rate());
  if (options.source.set) BITELINE_TRY(try_settings(*kind));
  BITELINE_TRY(runtime::prepare_process(demand));
  BITELINE_TRY(runtime::enter_thread(runtime::threads::k_main, demand));
  BITELINE_ASSIGN(const std::unique_ptr<stream::StreamSocket> socket, open_network(options, demand));
  const hal::MonotonicClock clock;
  BITELINE_ASSIGN(const std::unique_ptr<runtime::LaserWatch> laser, start_laser_watch(*kind, clock, demand));

  sensor::StreamerConfig config;
  config.server.store_bytes = options.store_megabytes * 1024 * 1024;
  BITELINE_ASSIGN(config.pipeline, sensor::pipeline_config(options.peaks, kind->recorded));
  config.told = {.capture = options.source.capture, .peaks = options.told_peaks};
  config.record = options.record;
  config.record_pictures_every = options.record_pictures_every;
  config.record_keep_bytes = static_cast<std::uint64_t>(1e9 * options.record_keep_gb);
  config.record_every = options.record_every;
  config.record_asked = options.record_asked;
  config.realtime = demand;
  config.name = options.name;
  config.version = BITELINE_VERSION;
  config.leave_after_scan = kind->recording && !options.stay_after_scan;
  sensor::Streamer streamer{config, *kind, *socket, clock, laser.get()};
  if (kind->recording) BITELINE_TRY(streamer.start_scan());
  // For whoever started this program: one line, then nothing more on stdout.
  std::printf("{\"endpoint\":\"%s\",\"protocol\":%d}\n", socket->address().c_str(),
              static_cast<int>(wire::k_protocol));
  std::fflush(stdout);

  // A recording is no unit.
  UnitCount count{kind->recording ? std::nullopt : options.upkeep, laser.get(), streamer};
  std::atomic<bool> stop{false};
  std::atomic<bool> stream_over{false};
  Result<void> entered;
  std::thread stream_thread{[&] {
    entered = runtime::enter_thread(runtime::threads::k_stream, demand);
    if (entered) streamer.run(stop);
    stream_over = true;
  }};
  wait_for_signal(signals, stream_over, stop, [&] { count.see(); });
  stream_thread.join();
  if (laser) laser->stop();
  count.see();
  count.write();
  BITELINE_TRY(entered);
  // Of a live sensor the hosts were told; a recording that cannot be played is this run's own failure.
  if (kind->recording && streamer.failure()) return tl::unexpected<Error>{*streamer.failure()};
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  biteline::install_last_words("biteline-sensor");
  const sigset_t signals = block_stop_signals();
  try {
    const sensor::ParsedOptions parsed = sensor::parse_options(argc, argv);
    if (parsed.leave_with) return *parsed.leave_with;
    const Result<void> done = parsed.options.make_keys    ? wire::make_sensor_keys(*parsed.options.make_keys)
                              : parsed.options.keep       ? keep_scan(parsed.options)
                              : parsed.options.check      ? check(parsed.options)
                              : parsed.options.check_rate ? check_rate(parsed.options)
                              : parsed.options.stills     ? take_stills(parsed.options, signals)
                                                          : run(parsed.options, signals);
    if (done) return static_cast<int>(ExitStatus::Done);
    std::fprintf(stderr, "biteline-sensor: %s\n", to_line(done.error()).c_str());
    return static_cast<int>(error_row(done.error().code).exit_status);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "biteline-sensor: out of memory: raise the limit or free some, then start again\n");
    return static_cast<int>(biteline::ExitStatus::Connection);
  } catch (const std::exception& error) {
    // Out of memory, no thread to be had: nothing else here throws.
    std::fprintf(stderr, "biteline-sensor: internal failure: %s\n", error.what());
    return static_cast<int>(ExitStatus::Connection);
  }
}
