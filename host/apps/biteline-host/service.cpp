// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/service.hpp"

#include <pthread.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <thread>
#include <utility>

#include "host/apps/biteline-host/arm_lock.hpp"
#include "host/apps/biteline-host/attempt.hpp"
#include "host/report/report.hpp"
#include "host/results/line_result.hpp"
#include "host/transfer/library.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr Nanoseconds k_turn = milliseconds{100};
/// While a result is being worked out: nobody shall wait for it longer than this after it is done.
constexpr Nanoseconds k_wait = milliseconds{5};
constexpr milliseconds k_before_retry{1000};
/// A sensor tells its state a few times a second: so long the last word about the light is waited for.
constexpr Nanoseconds k_last_health = milliseconds{1000};
/// Any number will do: one command is under way at a time.
constexpr std::uint32_t k_start_id = 1;
constexpr const char* k_lock_name = "biteline-host.lock";

void complain(const Error& error) {
  std::fprintf(stderr, "biteline-host: %s\n", to_line(error).c_str());
}

/// A scan's own exceptions (memory, text that no JSON takes) are the scan's, not the service's.
template <class Work>
Result<ExitStatus> without_exceptions(Work&& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    return fail(Errc::ContractBroken, "%.200s", error.what());
  }
}

HostClock::time_point now() {
  return HostClock::time_point{
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}

ControllerAddress controller_of(const RobotOptions& robot) {
  return {.rtde = robot.rtde, .script = robot.script, .dashboard = robot.dashboard};
}

/// Who started this service: a person's word is his.
std::string user_name() {
  passwd entry{};
  passwd* found = nullptr;
  char buffer[1024];
  if (getpwuid_r(::getuid(), &entry, buffer, sizeof buffer, &found) == 0 && found != nullptr)
    return found->pw_name;
  return "user " + std::to_string(::getuid());
}

std::string utc_now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm parts{};
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&seconds, &parts));
  return text;
}

/// In small steps, so that a stop is heeded.
void wait_before_retry(const std::atomic<bool>& stop) {
  for (milliseconds waited{0}; waited < k_before_retry && !stop; waited += milliseconds{50}) {
    std::this_thread::sleep_for(milliseconds{50});
  }
}

}  // namespace

Result<Service> Service::create(const Options& options) {
  std::optional<wire::HostKeys> keys;
  if (options.keys) {
    BITELINE_ASSIGN(keys, wire::read_host_keys(*options.keys));
  }
  std::optional<Robot> robot;
  if (options.robot) {
    robot.emplace();
    robot->options = *options.robot;
    BITELINE_ASSIGN(robot->arm, kinematics::arm_model(options.robot->arm));
    BITELINE_ASSIGN(robot->process, path::read_process(options.robot->process));
  }
  std::optional<Carrier> carrier;
  if (options.sample) {
    carrier.emplace(
        Carrier{.name = options.sample->sample, .sample = {}, .options = options.sample->transfer});
    BITELINE_ASSIGN(carrier->sample, transfer::find_sample(options.sample->sample,
                                                           transfer::Library{options.sample->library}));
  }
  BITELINE_TRY(report::prepare_folder(options.out));
  const std::string holder = "biteline-host " + std::to_string(::getpid()) + " of " + options.out.string();
  BITELINE_ASSIGN(report::FileLock results, report::FileLock::take(options.out / k_lock_name, holder));
  Locks locks{.results = std::move(results), .arm = {}};
  if (options.robot && options.robot->send) {
    BITELINE_ASSIGN(const HostPort script, parse_host_port(options.robot->script));
    BITELINE_ASSIGN(locks.arm, hold_arm(script.host, script.port, holder));
  }
  return Service{options, std::move(keys), std::move(robot), std::move(carrier), std::move(locks)};
}

Service::Service(Options options, std::optional<wire::HostKeys> keys, std::optional<Robot> robot,
                 std::optional<Carrier> carrier, Locks locks)
    : options_{std::move(options)},
      keys_{std::move(keys)},
      robot_{std::move(robot)},
      carrier_{std::move(carrier)},
      locks_{std::move(locks)} {}

Result<ExitStatus> Service::run(const std::atomic<bool>& stop) {
  stop_ = &stop;
  find_unfinished();
  while (!stop) {
    if (!scan_ && !result_.valid() && !unfinished_.empty()) {
      const fs::path folder = std::move(unfinished_.front());
      unfinished_.pop_front();
      if (const Result<void> taken = take_up(folder); !taken) complain(taken.error());
      start_result();
      if (!scan_ && !result_.valid()) continue;
    }
    const Result<void> heard = hear_sensor();
    if (!heard) {
      link_.reset();
      // With the scan in, nobody waits for the sensor any more.
      const bool scan_in = scan_ && scan_->intake.ended();
      if (options_.once && !result_.valid() && !scan_in) return tl::unexpected<Error>{heard.error()};
      complain(heard.error());
      wait_before_retry(stop);
    }
    start_result();
    if (const std::optional<Result<ExitStatus>> status = result_done()) {
      if (options_.once) return *status;
      if (!*status) complain(status->error());
    }
  }
  // An arm that was stopped on the way is no done job, and whoever said stop is told.
  if (!result_.valid()) return ExitStatus::Done;
  const Result<ExitStatus> last = result_.get();
  if (!last || options_.once) return last;
  return ExitStatus::Done;
}

Result<void> Service::hear_sensor() {
  if (!link_ && options_.once && result_.valid()) {
    result_.wait_for(k_wait);
    return {};
  }
  if (!link_) {
    intake::SensorLinkConfig config;
    config.sensor = options_.sensor;
    config.keys = keys_;
    config.protocol.acknowledge_by_itself = false;
    if (scan_) config.protocol.resume = scan_->intake.position();
    BITELINE_ASSIGN(link_, intake::SensorLink::open(config));
    ++links_;
    sensor_idle_ = false;
  }
  // The next scan only once the arm is out of its way, and what was left of earlier ones is done.
  if (sensor_idle_ && !scan_ && !result_.valid() && unfinished_.empty()) {
    sensor_idle_ = false;
    if (robot_ && robot_->options.send) tell_controller(controller_of(robot_->options));
    link_->command({.id = k_start_id, .command = wire::Command::StartScan});
  }
  BITELINE_ASSIGN(const std::optional<intake::LinkEvent> event,
                  link_->next(result_.valid() ? k_wait : k_turn));
  if (event) BITELINE_TRY(on_event(*event));
  return {};
}

void Service::start_result() {
  if (!scan_ || !ready(*scan_) || result_.valid()) return;
  result_ = std::async(std::launch::async, [this, scan = std::move(*scan_)]() mutable {
    pthread_setname_np(pthread_self(), "bl-result");
    return work_out(std::move(scan));
  });
  scan_.reset();
  sensor_idle_ = true;
}

std::optional<Result<ExitStatus>> Service::result_done() {
  if (!result_.valid() || result_.wait_for(Nanoseconds{0}) != std::future_status::ready) return std::nullopt;
  return result_.get();
}

Result<void> Service::on_event(const intake::LinkEvent& event) {
  if (const auto* hello = std::get_if<intake::Hello>(&event)) return on_hello(*hello);
  if (const auto* reply = std::get_if<wire::ControlReply>(&event)) {
    if (reply->errc == 0) return {};
    return fail(Errc::PeerRefused, "the sensor does not begin a scan: %s", reply->where.c_str());
  }
  if (!scan_) return {};  // the rest of a scan that was over before this host came
  const std::size_t before = scan_->intake.cloud().size();
  BITELINE_TRY(scan_->intake.take(event, link_->packet()));
  if (scan_->intake.ended() && !scan_->ended) {
    scan_->ended = now();
    scan_->one_connection = !scan_->recovered && scan_->connection == connection();
  }
  link_->acknowledge();
  if (const auto* profile = std::get_if<intake::ProfileEvent>(&event); profile && scan_->line) {
    scan_->line->add_profile(profile->profile.header.sequence,
                             std::span{scan_->intake.cloud().points}.subspan(before));
  }
  return {};
}

Result<void> Service::on_hello(const intake::Hello& hello) {
  if (scan_ && !hello.resumed) {
    // What there is of it is kept and told; it is not a result.
    say_step("the sensor no longer has the rest of %s", scan_->folder.filename().c_str());
    Scan cut_off = std::move(*scan_);
    scan_.reset();
    BITELINE_TRY(work_out(std::move(cut_off)));
  }
  if (scan_) {
    say_step("goes on with %s at profile %llu", scan_->folder.filename().c_str(),
             static_cast<unsigned long long>(scan_->intake.profiles()));
    return {};
  }
  const bool has_scan = hello.scan_id != 0 && (hello.sensor.scanning || hello.sensor.lossless);
  if (!has_scan) {
    say_step("connected to %s%s; asks for a scan", hello.sensor.name.c_str(),
             hello.sensor.simulated ? " (simulated)" : "");
    sensor_idle_ = true;
    return {};
  }
  const fs::path folder = next_folder();
  BITELINE_TRY(report::prepare_folder(folder));
  BITELINE_ASSIGN(intake::ScanIntake intake, intake::ScanIntake::begin(folder, hello, link_->packet()));
  hold_scan(folder, std::move(intake));
  say_step("takes in scan '%s' of %s%s into %s", hello.sensor.scan_name.c_str(), hello.sensor.name.c_str(),
           hello.sensor.simulated ? " (simulated)" : "", folder.c_str());
  return {};
}

void Service::hold_scan(const fs::path& folder, intake::ScanIntake intake) {
  scan_.emplace(Scan{.folder = folder, .intake = std::move(intake), .line = {}, .connection = connection()});
  if (carrier_) return;
  scan_->line = std::make_unique<intake::LiveLine>(bite_line::Config{});
  scan_->line->add_profiles(scan_->intake.cloud());
}

void Service::find_unfinished() {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator{options_.out, error}) {
    if (!intake::ScanIntake::is_in(entry.path())) continue;
    const bool done = fs::exists(entry.path() / "report.json", error);
    if (!done || confirmed(entry.path())) unfinished_.push_back(entry.path());
  }
  std::ranges::sort(unfinished_);
}

Result<void> Service::take_up(const fs::path& folder) {
  if (was_attempted(folder) && !confirmed(folder))
    return set_aside(folder, "an earlier run of this service died while it worked it out");
  BITELINE_TRY(mark_attempt(folder));
  Result<intake::ScanIntake> intake = intake::ScanIntake::recover(folder);
  clear_attempt(folder);
  if (!intake) return tl::unexpected<Error>{intake.error()};
  say_step("found %s unfinished, with %llu profiles", folder.filename().c_str(),
           static_cast<unsigned long long>(intake->profiles()));
  hold_scan(folder, std::move(*intake));
  scan_->recovered = true;
  // A connection made before would go on with another scan; the next one asks for the rest of this.
  if (!scan_->intake.ended()) link_.reset();
  return {};
}

bool Service::confirmed(const fs::path& folder) const {
  return robot_ && !robot_->options.confirm.empty() && folder.filename() == robot_->options.confirm;
}

fs::path Service::next_folder() const {
  std::error_code error;
  for (int number = 1;; ++number) {
    char name[32];
    std::snprintf(name, sizeof name, "scan-%04d", number);
    if (!fs::exists(options_.out / name, error)) return options_.out / name;
  }
}

Result<ExitStatus> Service::work_out(Scan scan) const {
  BITELINE_TRY(mark_attempt(scan.folder));
  intake::ScanOutcome outcome;
  std::optional<cloud::ClosedLine> line;
  Result<ExitStatus> status = without_exceptions([&] { return work_out_line(scan, outcome, line); });
  if (!status) {
    // A disk that is full or a folder that is gone is not the scan's fault: it is taken up again.
    const bool own_fault = status.error().code != Errc::DiskFull && status.error().code != Errc::WriteFailed;
    if (!own_fault) clear_attempt(scan.folder);
    if (!own_fault || !set_aside(scan.folder, to_line(status.error()))) return status;
    return ExitStatus::Refused;
  }
  clear_attempt(scan.folder);
  if (!line || !robot_) {
    if (!options_.keep_recording) scan.intake.forget();
    return status;
  }
  return without_exceptions([&] { return work_out_path(scan, outcome, *line); });
}

Result<ExitStatus> Service::work_out_line(Scan& scan, intake::ScanOutcome& outcome,
                                          std::optional<cloud::ClosedLine>& line) const {
  outcome = scan.intake.finish();
  BITELINE_ASSIGN(LineStep step, carrier_ ? carry_line(scan.folder, *carrier_, outcome)
                                          : find_line(scan.folder, outcome, *scan.line));
  line = std::move(step.line);
  return step.status;
}

Result<ExitStatus> Service::work_out_path(Scan& scan, const intake::ScanOutcome& outcome,
                                          const cloud::ClosedLine& line) const {
  const PlanStepRequest request{
      .arm = robot_->arm, .process = robot_->process, .table_z_mm = robot_->options.table_z_mm};
  BITELINE_ASSIGN(const PlanStep plan, plan_path(scan.folder / "path", request, outcome, line));
  const bool wanted = plan.outcome.path && robot_->options.send;
  const robot::ScanFacts facts = facts_of(scan, outcome);
  // What a person may still say yes to stays whole.
  const bool seen = !facts.recovered && !facts.from_recording && facts.one_connection;
  const bool waits_for_a_word = wanted && !facts.confirmed && (!seen || robot_->process.gate.approval);
  if (!options_.keep_recording && !waits_for_a_word) scan.intake.forget();
  if (!wanted) return plan.status;
  return follow_path(scan.folder, plan,
                     {.controller = controller_of(robot_->options),
                      .serial = robot_->options.serial,
                      .holds_arm = locks_.arm.has_value(),
                      .scan = facts,
                      .scan_ended = scan.recovered ? std::nullopt : scan.ended},
                     *stop_);
}

robot::ScanFacts Service::facts_of(const Scan& scan, const intake::ScanOutcome& outcome) const {
  robot::ScanFacts facts{
      .name = scan.folder.filename().string(),
      .scan_id = scan.intake.scan_id(),
      .recovered = scan.recovered,
      .from_recording = outcome.sensor.lossless,
      .one_connection = scan.one_connection,
      .messages_lost = outcome.messages_lost,
      .lost = {
          .frames = outcome.lost.frames, .profiles = outcome.lost.profiles, .edges = outcome.lost.edges}};
  if (confirmed(scan.folder)) facts.confirmed = robot::Word{.by = user_name(), .at = utc_now()};
  return facts;
}

int Service::connection() const {
  // A link counts its own renewals; no link has had a thousand.
  return 1000 * links_ + (link_ ? link_->reconnects() : 0);
}

bool Service::ready(const Scan& scan) {
  if (!scan.intake.ended()) return false;
  const bool has_light = !scan.intake.sensor().lossless;
  if (scan.recovered || scan.intake.light_told() || !has_light || !scan.ended) return true;
  return now() - *scan.ended > k_last_health;
}

}  // namespace biteline::service
