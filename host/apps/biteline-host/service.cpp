// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/service.hpp"

#include <pthread.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <thread>
#include <utility>

#include "host/apps/biteline-host/arm_lock.hpp"
#include "host/apps/biteline-host/attempt.hpp"
#include "host/apps/biteline-host/recognise.hpp"
#include "host/apps/biteline-host/scan_row.hpp"
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
/// Only the answer to a start matters: a stop has done its work or there was nothing to stop.
constexpr std::uint32_t k_start_id = 1;
constexpr std::uint32_t k_stop_id = 2;
/// A robot that is not ready, or a page that ended, is looked at again.
constexpr Nanoseconds k_between_looks = milliseconds{2000};
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

/// Beside the program, as installed and as built.
fs::path shipped_processes() {
  return intake::program_folder().parent_path() / "share/biteline/processes";
}

/// For this user alone.
Result<void> write_secret(const fs::path& file, const std::string& text) {
  const mode_t before = ::umask(0077);
  const Result<void> written = report::write_file_atomically(file, text);
  ::umask(before);
  return written;
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
  std::optional<wire::SensorKeys> control_keys;
  if (options.doors.keys) {
    BITELINE_ASSIGN(control_keys, wire::read_sensor_keys(*options.doors.keys));
  }
  const std::string holder = "biteline-host " + std::to_string(::getpid()) + " of " + options.out.string();
  BITELINE_ASSIGN(report::FileLock results, report::FileLock::take(options.out / k_lock_name, holder));
  Locks locks{.results = std::move(results), .arm = {}};
  if (options.robot && options.robot->send) {
    BITELINE_ASSIGN(const HostPort script, parse_host_port(options.robot->script));
    BITELINE_ASSIGN(locks.arm, hold_arm(script.host, script.port, holder));
  }
  BITELINE_ASSIGN(std::unique_ptr<Cockpit> cockpit,
                  Cockpit::open({.results = options.out,
                                 .shipped_processes = shipped_processes(),
                                 .library = options.library,
                                 .sensor = options.sensor.text(),
                                 .arm = robot ? robot->arm.name : "",
                                 .controller = robot ? robot->options.script : "",
                                 .process = robot ? robot->process.name : "",
                                 .endpoint = options.doors.control,
                                 .keys = std::move(control_keys)}));
  if (options.doors.guest) {
    BITELINE_ASSIGN(const std::string token, cockpit->accounts().make_guest_token());
    BITELINE_TRY(write_secret(*options.doors.guest, token + "\n"));
  }
  return Service{options,          std::move(keys),   std::move(robot), std::move(carrier),
                 std::move(locks), std::move(cockpit)};
}

Service::Service(Options options, std::optional<wire::HostKeys> keys, std::optional<Robot> robot,
                 std::optional<Carrier> carrier, Locks locks, std::unique_ptr<Cockpit> cockpit)
    : options_{std::move(options)},
      keys_{std::move(keys)},
      robot_{std::move(robot)},
      carrier_{std::move(carrier)},
      locks_{std::move(locks)},
      cockpit_{std::move(cockpit)} {}

Result<ExitStatus> Service::run(const std::atomic<bool>& stop) {
  stop_ = &stop;
  if (const Result<int> rows = take_up_rows(cockpit_->memory(), options_.out); !rows) complain(rows.error());
  if (cockpit_->has_doors()) say_step("doors come in at %s", cockpit_->address().c_str());
  find_unfinished();
  while (!stop) {
    keep_web();
    heed_wishes();
    if (!scan_ && !result_.valid() && !held_ && !unfinished_.empty()) {
      const fs::path folder = std::move(unfinished_.front());
      unfinished_.pop_front();
      if (const Result<void> taken = take_up(folder); !taken) complain(taken.error());
      start_result();
      if (!scan_ && !result_.valid()) continue;
    }
    const Result<void> heard = hear_sensor();
    if (!heard) {
      link_.reset();
      sensor_heard_ = false;
      cockpit_->lose_sensor(to_line(heard.error()));
      // With the scan in, nobody waits for the sensor any more.
      const bool scan_in = scan_ && scan_->intake.ended();
      if (options_.once && !result_.valid() && !held_ && !scan_in)
        return tl::unexpected<Error>{heard.error()};
      complain(heard.error());
      wait_before_retry(stop);
    }
    start_result();
    if (const std::optional<Result<ExitStatus>> status = result_done()) {
      if (options_.once && !held_) return *status;
      if (!*status) complain(status->error());
    }
    show_idle();
  }
  cockpit_->halt();
  // An arm that was stopped on the way is no done job, and whoever said stop is told.
  if (!result_.valid()) return ExitStatus::Done;
  const Result<ExitStatus> last = result_.get();
  if (!last || options_.once) return last;
  return ExitStatus::Done;
}

void Service::show_idle() {
  // While a result is worked out, what is held belongs to its thread.
  if (result_.valid()) return;
  if (held_) {
    if (!told_held_) {
      cockpit_->hold(held_->folder.filename().string());
      cockpit_->tell_scan(held_->folder.filename().string());
      told_held_ = true;
    }
    cockpit_->show(Phase::Deciding, held_->folder.filename().string() + " waits for a person",
                   "accept it, reject it, or scan again");
    return;
  }
  if (scan_) return;
  if (cockpit_->paused()) {
    cockpit_->show(Phase::Stopped, "stopped", "start, when the cell is clear");
  } else if (!sensor_heard_) {
    cockpit_->show(Phase::Fault, "no sensor", "it is called again each second");
  } else if (robot_wrong_) {
    cockpit_->show(Phase::Fault, "the robot is not ready", "the next scan, once it is");
  } else {
    cockpit_->show(Phase::Waiting, "waits for the sensor", "the next scan");
  }
}

void Service::keep_web() {
  if (!options_.doors.web) return;
  // Its words, without waiting for any: the sensor must hear this thread.
  while (web_) {
    const Result<std::string> line = web_->next_line(milliseconds{0});
    if (!line) break;
    say_step("%s", line->c_str());
  }
  if (web_ && web_->running()) return;
  if (web_) {
    say_step("biteline-web has ended: %s; it is started again", web_->last_words().c_str());
    web_.reset();
  }
  if (web_started_ != HostClock::time_point{} && now() - web_started_ < k_between_looks) return;
  web_started_ = now();
  std::vector<std::string> arguments{"--control", cockpit_->address(), "--exit-with-parent"};
  if (!options_.doors.web_address.empty())
    arguments.insert(arguments.end(), {"--listen", options_.doors.web_address});
  auto web = intake::ChildProcess::start({.program = intake::program_folder() / "biteline-web",
                                          .arguments = std::move(arguments),
                                          .pass_stderr = true});
  if (!web) return complain(web.error());
  web_.emplace(std::move(*web));
}

void Service::heed_wishes() {
  while (const std::optional<Wish> wish = cockpit_->next_wish()) heed(*wish);
}

void Service::heed(const Wish& wish) {
  switch (wish.kind) {
    case Wish::Kind::Stop:
    case Wish::Kind::LaserOff:
      say_step("%s by %s", wish.kind == Wish::Kind::Stop ? "stopped" : "laser off", wish.who.c_str());
      if (link_) {
        link_->command(
            {.id = k_stop_id,
             .command = wish.kind == Wish::Kind::Stop ? wire::Command::StopScan : wire::Command::LaserOff});
      }
      return;
    case Wish::Kind::Start:
    case Wish::Kind::Rescan:
      say_step("%s by %s", wish.kind == Wish::Kind::Start ? "started" : "scanned again", wish.who.c_str());
      if (wish.kind == Wish::Kind::Start) {
        const std::lock_guard lock{*job_mutex_};
        job_ = wish.job;
      }
      // What a stop cut short is over; an idle sensor is asked.
      if (link_ && !scan_ && !result_.valid()) sensor_idle_ = true;
      return;
    case Wish::Kind::Send:
    case Wish::Kind::Reject:
      if (result_.valid() || !held_ || held_->folder.filename() != wish.scan) return;
      told_held_ = false;
      if (wish.kind == Wish::Kind::Reject) {
        say_step("%s is rejected by %s", wish.scan.c_str(), wish.who.c_str());
        if (!options_.keep_recording) held_->intake.forget();
        held_.reset();
        return;
      }
      say_step("%s is accepted by %s", wish.scan.c_str(), wish.who.c_str());
      result_ = std::async(
          std::launch::async,
          [this, held = std::move(*held_), word = robot::Word{.by = wish.who, .at = utc_now()}]() mutable {
            pthread_setname_np(pthread_self(), "bl-result");
            return send_held(std::move(held), word);
          });
      held_.reset();
      return;
    case Wish::Kind::Hold:
      return;
  }
}

bool Service::robot_ready() {
  if (!robot_ || !robot_->options.send) return true;
  if (robot_wrong_ && now() - robot_asked_ < k_between_looks) return false;
  const ControllerLook look =
      look_at_controller(controller_of(robot_->options), robot_->arm.name, robot_->options.serial);
  robot_asked_ = now();
  const bool was_wrong = std::exchange(robot_wrong_, !look.wrong.empty());
  cockpit_->hear(look.words, look.wrong);
  if (robot_wrong_ && !was_wrong) say_step("no scan is spent: %s", look.wrong.c_str());
  return !robot_wrong_;
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
  if (sensor_idle_ && !scan_ && !result_.valid() && !held_ && unfinished_.empty() && !cockpit_->paused()) {
    // A robot that is not ready would cost a scan that nobody can use.
    if (!robot_ready()) {
      if (options_.once)
        return fail(Errc::DeviceError, "robot %s: it is not ready", robot_->options.script.c_str());
      BITELINE_ASSIGN(const std::optional<intake::LinkEvent> meanwhile, link_->next(k_turn));
      if (meanwhile) BITELINE_TRY(on_event(*meanwhile));
      return {};
    }
    sensor_idle_ = false;
    cockpit_->begin_cycle();
    link_->command({.id = k_start_id, .command = wire::Command::StartScan});
  }
  BITELINE_ASSIGN(const std::optional<intake::LinkEvent> event,
                  link_->next(result_.valid() ? k_wait : k_turn));
  if (event) BITELINE_TRY(on_event(*event));
  return {};
}

void Service::start_result() {
  if (!scan_ || !ready(*scan_) || result_.valid() || held_) return;
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
  if (const auto* hello = std::get_if<intake::Hello>(&event)) {
    sensor_heard_ = true;
    cockpit_->hear(hello->sensor);
    return on_hello(*hello);
  }
  if (const auto* health = std::get_if<wire::Health>(&event)) cockpit_->hear(*health);
  if (const auto* reply = std::get_if<wire::ControlReply>(&event)) {
    if (reply->errc == 0 || reply->id != k_start_id) return {};
    return fail(Errc::PeerRefused, "the sensor does not begin a scan: %s", reply->where.c_str());
  }
  if (!scan_) return {};  // the rest of a scan that was over before this host came
  const std::size_t before = scan_->intake.cloud().size();
  BITELINE_TRY(scan_->intake.take(event, link_->packet()));
  cockpit_->show_progress(scan_->intake.profiles(), scan_->intake.profiles_expected());
  if (scan_->intake.ended() && !scan_->ended) {
    scan_->ended = now();
    scan_->one_connection = !scan_->recovered && scan_->connection == connection();
  }
  link_->acknowledge();
  if (const auto* profile = std::get_if<intake::ProfileEvent>(&event); profile && scan_->line) {
    scan_->line->add_profile(profile->profile.header.sequence,
                             std::span{scan_->intake.cloud().points}.subspan(before),
                             intake::pose_of(profile->profile.header));
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
  cockpit_->show_scan(folder.filename().string());
  cockpit_->show(Phase::Scanning, folder.filename().string() + " comes in", "its line");
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
  // Not a name that the memory knows: its folder may be gone, its row stays.
  int number = 1;
  memory::ScanFilter last;
  last.limit = 1;
  if (const Result<memory::ScanPage> newest = cockpit_->memory().scans(last);
      newest && !newest->scans.empty())
    number = 1 + std::atoi(newest->scans.front().name.c_str() + std::strlen("scan-"));
  std::error_code error;
  for (;; ++number) {
    char name[32];
    std::snprintf(name, sizeof name, "scan-%04d", number);
    const Result<std::optional<memory::Scan>> known = cockpit_->memory().scan(name);
    if (!fs::exists(options_.out / name, error) && !(known && *known)) return options_.out / name;
  }
}

Result<ExitStatus> Service::work_out(Scan scan) {
  const std::string name = scan.folder.filename().string();
  cockpit_->show(Phase::Working, "works out the line of " + name, robot_ ? "its path" : "the next scan");
  const fs::path folder = scan.folder;
  Result<ExitStatus> status = work_out_files(scan);
  std::string decision = "open";
  if (held_) {
    decision = "held";
  } else if (robot_ && process_of(scan.chosen).gate.automatic_above) {
    decision = "automatic";
  }
  remember(folder, decision, scan.chosen);
  if (const Result<void> room = make_room(); !room) complain(room.error());
  return status;
}

Result<ExitStatus> Service::work_out_files(Scan& scan) {
  BITELINE_TRY(mark_attempt(scan.folder));
  intake::ScanOutcome outcome;
  LineStep line;
  Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    BITELINE_ASSIGN(line, work_out_line(scan, outcome));
    return line.status;
  });
  if (!status) {
    // A disk that is full or a folder that is gone is not the scan's fault: it is taken up again.
    const bool own_fault = status.error().code != Errc::DiskFull && status.error().code != Errc::WriteFailed;
    if (!own_fault) clear_attempt(scan.folder);
    if (!own_fault || !set_aside(scan.folder, to_line(status.error()))) return status;
    return ExitStatus::Refused;
  }
  clear_attempt(scan.folder);
  if (!line.line || !robot_) {
    if (!options_.keep_recording) scan.intake.forget();
    return status;
  }
  return without_exceptions([&] { return work_out_path(scan, outcome, line); });
}

Result<LineStep> Service::work_out_line(Scan& scan, intake::ScanOutcome& outcome) {
  outcome = scan.intake.finish();
  if (carrier_) {
    scan.chosen.model = carrier_->name;
    return carry_line(scan.folder, *carrier_, outcome);
  }
  BITELINE_ASSIGN(LineStep found, find_line(scan.folder, outcome, *scan.line, options_.uncertainty));
  return use_library(scan, outcome, std::move(found));
}

Result<LineStep> Service::use_library(Scan& scan, const intake::ScanOutcome& outcome, LineStep found) {
  Chosen& chosen = scan.chosen;
  {
    const std::lock_guard lock{*job_mutex_};
    chosen.model = job_.model;
    chosen.process_name = job_.process;
  }
  const transfer::Library library{options_.library};
  if (outcome.failure || (!options_.models && chosen.model.empty())) {
    BITELINE_TRY(choose_process(library, chosen));
    return found;
  }
  chosen.probability = 1;
  std::optional<transfer::Alignment> alignment;
  if (chosen.model.empty()) {
    BITELINE_ASSIGN(Recognised model, recognise(library, outcome.cloud));
    say_step("%s", model.words.c_str());
    cockpit_->show_model(model.name, model.probability, chosen.process_name);
    if (!model.sure()) {
      BITELINE_TRY(refuse_unknown(scan.folder, model.words));
      return LineStep{.status = ExitStatus::Refused, .confidence = 0, .line = {}};
    }
    chosen.model = model.name;
    chosen.probability = model.probability;
    alignment = std::move(model.alignment);
  }
  BITELINE_ASSIGN(transfer::SampleFiles sample, library.load(chosen.model));
  BITELINE_TRY(choose_process(library, chosen));
  cockpit_->show_model(chosen.model, chosen.probability, chosen.process_name);
  if (found.line) {
    if (alignment) chosen.places = places_of(*found.line, sample.line, alignment->T_upper_sample);
    return found;
  }
  // An upper without its sole: the model's line is carried over.
  return carry_line(scan.folder, {.name = chosen.model, .sample = std::move(sample), .options = {}}, outcome);
}

Result<void> Service::choose_process(const transfer::Library& library, Chosen& chosen) const {
  if (!robot_) return {};
  fs::path file;
  if (!chosen.process_name.empty()) {
    BITELINE_ASSIGN(
        const api::StoredProcess stored,
        api::ProcessStore(shipped_processes(), options_.out / "processes").find(chosen.process_name));
    file = stored.file;
  } else if (!chosen.model.empty() && fs::exists(library.path_of(chosen.model) / transfer::k_process_file)) {
    file = library.path_of(chosen.model) / transfer::k_process_file;
  }
  if (file.empty()) {
    chosen.process_name = robot_->process.name;
    return {};
  }
  BITELINE_ASSIGN(chosen.process, path::read_process(file));
  chosen.process_name = chosen.process->name;
  return {};
}

const path::Process& Service::process_of(const Chosen& chosen) const {
  return chosen.process ? *chosen.process : robot_->process;
}

Result<ExitStatus> Service::work_out_path(Scan& scan, const intake::ScanOutcome& outcome,
                                          const LineStep& line) {
  const std::string name = scan.folder.filename().string();
  const PlanStepRequest request{
      .arm = robot_->arm, .process = process_of(scan.chosen), .table_z_mm = robot_->options.table_z_mm};
  cockpit_->show(Phase::Working, "plans the path of " + name,
                 robot_->options.send ? "the arm follows it" : "the next scan");
  BITELINE_ASSIGN(PlanStep plan, plan_path(scan.folder / "path", request, outcome, *line.line));
  const bool wanted = plan.outcome.path && robot_->options.send;
  const robot::ScanFacts facts = facts_of(scan, outcome);
  SendRequest send{.controller = controller_of(robot_->options),
                   .serial = robot_->options.serial,
                   .holds_arm = locks_.arm.has_value(),
                   .scan = facts,
                   .confidence = line.confidence,
                   .approved = {},
                   .scan_ended = scan.recovered ? std::nullopt : scan.ended};
  const bool asks =
      needs_a_person(process_of(scan.chosen).gate, line.confidence) || cockpit_->wants_hold(name);
  if (wanted && asks && !facts.confirmed && cockpit_->has_doors()) {
    say_step("%s is held: a person must accept it", name.c_str());
    held_.emplace(Held{.folder = scan.folder,
                       .intake = std::move(scan.intake),
                       .plan = std::move(plan),
                       .request = std::move(send),
                       .chosen = scan.chosen});
    return ExitStatus::Done;
  }
  // What a person may still say yes to stays whole.
  const bool seen = !facts.recovered && !facts.from_recording && facts.one_connection;
  const bool waits_for_a_word = wanted && !facts.confirmed && (!seen || asks);
  if (!options_.keep_recording && !waits_for_a_word) scan.intake.forget();
  if (!wanted) return plan.status;
  cockpit_->show(Phase::Following, "the arm follows the line of " + name, "the next scan");
  return follow_path(scan.folder, plan, send, cockpit_->halted());
}

Result<ExitStatus> Service::send_held(Held held, const robot::Word& word) {
  cockpit_->show(Phase::Following, "the arm follows the line of " + held.folder.filename().string(),
                 "the next scan");
  held.request.approved = word;
  const Result<ExitStatus> status = without_exceptions(
      [&] { return follow_path(held.folder, held.plan, held.request, cockpit_->halted()); });
  if (!options_.keep_recording) held.intake.forget();
  remember(held.folder, "accepted", held.chosen);
  return status;
}

void Service::remember(const fs::path& folder, const std::string& decision, const Chosen& chosen) const {
  std::optional<memory::Scan> row = row_of(folder);
  if (!row) {
    // No report: a device or the disk failed, not the scan.
    row.emplace();
    row->name = folder.filename().string();
    row->time = memory::now_ms();
    row->verdict = "failed";
  }
  const Result<std::optional<memory::Scan>> before = cockpit_->memory().scan(row->name);
  row->decision = decision;
  if (before && *before) {
    // A person's word stands.
    row->decided_by = (*before)->decided_by;
    row->decided_at = (*before)->decided_at;
    row->why = (*before)->why;
    if ((*before)->decision == "rejected") row->decision = "rejected";
  }
  // Nothing was approved where nothing was sent.
  if (decision == "automatic" && !row->sent) row->decision = "open";
  if (row->decision == "automatic") row->decided_by = "automatic";
  if (const double cycle_s = cockpit_->cycle_s(); cycle_s > 0) row->cycle_s = cycle_s;
  row->process = chosen.process_name.empty() && robot_ ? robot_->process.name : chosen.process_name;
  row->model = chosen.model;
  if (chosen.probability > 0) row->model_probability = chosen.probability;
  if (const std::optional<accounts::Holder> holder = cockpit_->accounts().holder())
    row->operator_name = holder->name;
  row->versions = std::string{R"({"program":")"} + BITELINE_VERSION + R"("})";
  const Result<void> put = cockpit_->memory().put_scan(*row,
                                                       {.id = 0,
                                                        .time = row->time,
                                                        .who = "service",
                                                        .door = {},
                                                        .action = "result",
                                                        .subject = row->name,
                                                        .before = {},
                                                        .after = row->verdict},
                                                       chosen.places);
  if (!put) complain(put.error());
  cockpit_->tell_scan(row->name);
}

Result<void> Service::make_room() const {
  if (!options_.keep_days && !options_.keep_gb) return {};
  memory::Retention retention;
  if (options_.keep_days) {
    retention.oldest = memory::now_ms() - static_cast<memory::UnixMs>(*options_.keep_days *
                                                                      static_cast<double>(memory::k_day_ms));
  }
  if (options_.keep_gb) retention.most_bytes = static_cast<std::uint64_t>(*options_.keep_gb * 1e9);
  BITELINE_ASSIGN(const std::vector<std::string> go,
                  cockpit_->memory().folders_to_go(retention, options_.out));
  for (const std::string& name : go) {
    // The row first: a folder without one would be taken up again.
    BITELINE_TRY(cockpit_->memory().forget_folder(name, {.id = 0,
                                                         .time = memory::now_ms(),
                                                         .who = "service",
                                                         .door = {},
                                                         .action = "folder removed",
                                                         .subject = name,
                                                         .before = {},
                                                         .after = {}}));
    std::error_code error;
    fs::remove_all(options_.out / name, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", (options_.out / name).c_str());
  }
  return {};
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
