// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/service.hpp"

#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <thread>
#include <utility>

#include "host/apps/biteline-host/arm_lock.hpp"
#include "host/apps/biteline-host/scan_row.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/report/report.hpp"
#include "host/robot/kinematics/calibration.hpp"
#include "host/transfer/library.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr milliseconds k_before_retry{1000};

/// For this user alone.
Result<void> write_secret(const fs::path& file, const std::string& text) {
  const mode_t before = ::umask(0077);
  const Result<void> written = report::write_file_atomically(file, text);
  ::umask(before);
  return written;
}

/// In small steps, so that a stop is noticed.
void wait_before_retry(const std::atomic<bool>& stop) {
  for (milliseconds waited{0}; waited < k_before_retry && !stop; waited += milliseconds{50}) {
    std::this_thread::sleep_for(milliseconds{50});
  }
}

}  // namespace

Result<Service> Service::create(const Options& options, robot::Stops& stops) {
  std::optional<wire::HostKeys> keys;
  if (options.keys) {
    BITELINE_ASSIGN(keys, wire::read_host_keys(*options.keys));
  }
  std::optional<Robot> robot;
  if (options.robot) {
    robot.emplace();
    robot->options = *options.robot;
    BITELINE_ASSIGN(robot->arm, kinematics::arm_model(options.robot->arm));
    if (!options.robot->kinematics.empty()) {
      BITELINE_ASSIGN(robot->arm, kinematics::with_calibration(robot->arm, options.robot->kinematics));
    }
    if (options.robot->natural_hz) robot->arm.give = kinematics::joint_give(*options.robot->natural_hz, true);
    BITELINE_ASSIGN(robot->process, take_process(options.robot->process));
  }
  std::optional<Carrier> carrier;
  if (options.sample) {
    BITELINE_ASSIGN(
        transfer::SampleFiles sample,
        transfer::find_sample(options.sample->sample, transfer::Library{options.sample->library}));
    carrier.emplace(Carrier{.name = options.sample->sample,
                            .sample = transfer::ReadySample{std::move(sample)},
                            .options = options.sample->transfer});
    carrier->sample.make_all();
  }
  std::vector<line_control::Job> jobs;
  if (options.doors.jobs) {
    BITELINE_ASSIGN(jobs, line_control::read_jobs(*options.doors.jobs));
  }
  BITELINE_TRY(report::prepare_folder(options.out));
  std::optional<wire::SensorKeys> control_keys;
  if (options.doors.keys) {
    BITELINE_ASSIGN(control_keys, wire::read_sensor_keys(*options.doors.keys));
  }
  const std::string holder = "biteline-host " + std::to_string(::getpid()) + " of " + options.out.string();
  BITELINE_ASSIGN(report::FileLock results, report::FileLock::take(options.out / k_results_lock, holder));
  Locks locks{.results = std::move(results), .arm = {}, .claim = {}};
  if (options.robot && options.robot->send) {
    const bool is_other = !options.robot->arm_link.empty();
    BITELINE_ASSIGN(const HostPort at,
                    parse_host_port(is_other ? options.robot->arm_link : options.robot->script));
    BITELINE_ASSIGN(locks.arm, hold_arm(at.host, at.port, holder));
    if (is_other) {
      BITELINE_ASSIGN(locks.other, connect_arm(at));
    } else {
      BITELINE_ASSIGN(locks.claim, claim_arm(*options.robot));
    }
  }
  BITELINE_ASSIGN(std::unique_ptr<OperatorControl> operator_control,
                  OperatorControl::open(
                      {.results = options.out,
                       .catalogue = catalogue_folders(options),
                       .sensor = options.sensor.text(),
                       .arm = robot ? robot->arm.name : "",
                       .controller = !robot                            ? ""
                                     : robot->options.arm_link.empty() ? robot->options.script
                                                                       : robot->options.arm_link,
                       .rtde = robot && robot->options.arm_link.empty() ? robot->options.rtde : "",
                       .other = locks.other,
                       .process = robot ? robot->process.process.name : "",
                       .rerun_arm = robot ? std::optional{RerunArm{.model = robot->arm,
                                                                   .process = robot->process.process,
                                                                   .table_z_mm = robot->options.table_z_mm,
                                                                   .fixture = fixture_of(robot->options)}}
                                          : std::nullopt,
                       .endpoint = options.doors.control,
                       .keys = std::move(control_keys),
                       .day = options.day,
                       .jobs = std::move(jobs),
                       .stops = &stops}));
  std::optional<Confirm> confirm;
  if (robot && !robot->options.confirm.empty()) {
    BITELINE_ASSIGN(confirm, read_confirm(options.out, robot->options.confirm, operator_control->memory()));
  }
  if (options.doors.guest) {
    BITELINE_ASSIGN(const std::string token, operator_control->accounts().make_guest_token());
    BITELINE_TRY(write_secret(*options.doors.guest, token + "\n"));
  }
  return Service{options,           std::move(keys),
                 std::move(robot),  std::move(carrier),
                 std::move(locks),  std::move(operator_control),
                 std::move(confirm)};
}

Service::Service(Options options, std::optional<wire::HostKeys> keys, std::optional<Robot> robot,
                 std::optional<Carrier> carrier, Locks locks,
                 std::unique_ptr<OperatorControl> operator_control, std::optional<Confirm> confirm)
    : options_{std::move(options)},
      keys_{std::move(keys)},
      robot_{std::move(robot)},
      carrier_{std::move(carrier)},
      locks_{std::move(locks)},
      operator_control_{std::move(operator_control)},
      confirm_{std::move(confirm)} {}

Result<ExitStatus> Service::run(const std::atomic<bool>& stop) {
  stop_ = &stop;
  if (const Result<int> rows = take_up_rows(operator_control_->memory(), options_.out); !rows)
    log_error(rows.error());
  if (operator_control_->has_doors()) log_step("doors come in at %s", operator_control_->address().c_str());
  BITELINE_TRY(watch_pendant());
  BITELINE_TRY(watch_clamp());
  take_up_order();
  if (robot_ && options_.releases.empty()) {
    Chosen own;
    BITELINE_TRY(take_following(own));
  }
  find_unfinished();
  close_owed_looks();
  forget_used_part();
  look_for_next_folder();
  while (!stop) {
    supervise_web();
    heed_wishes();
    end_what_was_stopped();
    look_at_clamp();
    look_at_tool();
    look_at_centre();
    if (!scan_ && cut_off_.empty() && is_free() && !unfinished_.empty()) {
      const fs::path folder = std::move(unfinished_.front());
      unfinished_.pop_front();
      if (const Result<void> taken = take_up(folder); !taken) log_error(taken.error());
      start_result();
      if (!scan_ && is_free()) continue;
    }
    const Result<void> heard = hear_sensor();
    if (!heard) {
      link_.reset();
      sensor_lost_ = to_line(heard.error());
      // Light that comes on whenever somebody mends the sensor would surprise whoever asked for it.
      if (looks() && !scan_) give_up_look(sensor_lost_);
      if (inspects() && !scan_) give_up_inspection(sensor_lost_);
      operator_control_->enter(CellEvent::Lost);
      operator_control_->lose_sensor(sensor_lost_);
      if (scan_) {
        scan_->trouble = sensor_lost_;
        scan_->profiles_at_trouble = scan_->intake.profiles();
      }
      // With the scan in, nobody waits for the sensor any more.
      const bool scan_in = (scan_ && scan_->intake.ended()) || !cut_off_.empty();
      if (options_.once && is_free() && !scan_in) return tl::unexpected<Error>{heard.error()};
      log_error(heard.error());
      wait_before_retry(stop);
    }
    start_result();
    if (std::optional<Worked> worked = result_done()) {
      held_ = std::move(worked->held);
      after_ = std::move(worked->after);
      if (!worked->asks.empty()) {
        // Somebody may have said start already.
        const bool goes = operator_control_->cell().going() == Going::Goes;
        asks_ = goes ? std::string{} : worked->asks;
        if (goes) keep_asking({});
      }
      if (after_) operator_control_->enter(CellEvent::Inspects);
      if (is_free()) operator_control_->enter(CellEvent::Done);
      if (options_.once && is_free()) return worked->status;
      if (!worked->status) log_error(worked->status.error());
      rest_after(*worked);
    }
    show_idle();
  }
  operator_control_->halt();
  // An arm that was stopped on the way is no done job, and whoever said stop is told.
  if (!result_.valid()) return ExitStatus::Done;
  const Worked last = result_.get();
  if (!last.status || options_.once) return last.status;
  return ExitStatus::Done;
}

void Service::start_result() {
  if (result_.valid()) return;
  const bool whole = scan_ && ready(*scan_);
  if (!whole && cut_off_.empty()) return;
  const bool look = cut_off_.empty() ? scan_->look : cut_off_.front().look;
  const bool after_work = cut_off_.empty() ? scan_->after_work : cut_off_.front().after_work;
  if ((held_ && !look) || (after_ && !after_work)) return;
  Scan scan = cut_off_.empty() ? std::move(*scan_) : std::move(cut_off_.front());
  if (cut_off_.empty()) {
    scan_.reset();
    operator_control_->enter(CellEvent::ScanIsIn);
  } else {
    cut_off_.pop_front();
  }
  if (after_work) {
    if (!inspects()) return scan.intake.forget();
    const std::string of = after_->name();
    begin_result(of, [this, after = std::move(*after_), scan = std::move(scan)]() mutable {
      return inspect_work(std::move(after), std::move(scan));
    });
    after_.reset();
    return;
  }
  if (look) {
    // What it was to show has been stopped.
    if (!looks()) return scan.intake.forget();
    result_ =
        std::async(std::launch::async, [this, held = std::move(*held_), scan = std::move(scan)]() mutable {
          pthread_setname_np(pthread_self(), "bl-result");
          return look_at_held(std::move(held), std::move(scan));
        });
    held_.reset();
    return;
  }
  const std::string name = scan.folder.filename().string();
  begin_result(name, [this, scan = std::move(scan)]() mutable { return work_out(std::move(scan)); });
}

std::optional<Service::Worked> Service::result_done() {
  if (!result_.valid() || result_.wait_for(Nanoseconds{0}) != std::future_status::ready) return std::nullopt;
  return result_.get();
}

void Service::end_what_was_stopped() {
  // A look that comes in ends by itself.
  if (inspects() && after_->scan.mark.stopped() && !scan_ && cut_off_.empty())
    return give_up_inspection("it was stopped");
  if (result_.valid() || !held_) return;
  // A line that is being mended is a whole one when its row is written.
  if (!held_->scan.mark.stopped() || operator_control_->mends(held_->name())) return;
  // Not here: the memory may be slow, and the sensor must hear this thread.
  begin_result(held_->name(), [this, held = std::move(*held_)]() mutable -> Worked {
    log_step("%s waits no longer: it was stopped", held.name().c_str());
    end_recording(held.scan.intake, ExitStatus::Refused);
    const std::string asks = leave_step(held.scan);
    const Remembered told = remember(held.scan.folder, "open", held.scan.chosen, {.stopped = true});
    return {.status = ExitStatus::Refused, .held = {}, .end = told.end, .after = {}, .asks = asks};
  });
  held_.reset();
}

std::optional<Service::HeldScan> Service::take_held(const OperatorCommand& command) {
  if (held_ && held_->name() == command.scan) return std::exchange(held_, std::nullopt);
  // Else what the cell shows would not be what is.
  if (held_) tell_aside(false);
  return std::nullopt;
}

void Service::go_on(const OperatorCommand& command, HeldScan held) {
  const robot::Word word{.by = command.who, .at = utc_now()};
  const auto begin = [&](const char* words, auto work) {
    log_step("%s %s by %s", command.scan.c_str(), words, command.who.c_str());
    result_ = std::async(std::launch::async, [held = std::move(held), work = std::move(work)]() mutable {
      pthread_setname_np(pthread_self(), "bl-result");
      return work(std::move(held));
    });
  };
  switch (command.kind) {
    case OperatorCommand::Kind::Send:
      return begin("is accepted", [this, word](HeldScan one) { return send_held(std::move(one), word); });
    case OperatorCommand::Kind::Air:
      return begin("is run in the air",
                   [this, word](HeldScan one) { return run_in_air(std::move(one), word); });
    case OperatorCommand::Kind::Mended:
      return begin("has its line mended", [this](HeldScan one) { return plan_mended(std::move(one)); });
    case OperatorCommand::Kind::Model:
      return begin(
          ("is named " + command.job.model).c_str(),
          [this, model = command.job.model](HeldScan one) { return work_named(std::move(one), model); });
    case OperatorCommand::Kind::Process:
      return begin("gets another process",
                   [this, process = command.job.process, who = command.who](HeldScan one) {
                     return one.planned() ? plan_with(std::move(one), process, who)
                                          : work_with(std::move(one), process, who);
                   });
    case OperatorCommand::Kind::Look:
      // The sensor is asked when it is next heard; until then it stays here.
      log_step("%s is looked at again by %s", command.scan.c_str(), command.who.c_str());
      held_.emplace(std::move(held));
      return;
    default:
      held_.emplace(std::move(held));
  }
}

}  // namespace biteline::service
