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
#include "host/records/report/report.hpp"
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

/// In small steps, so that a stop is heeded.
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
    BITELINE_ASSIGN(const HostPort script, parse_host_port(options.robot->script));
    BITELINE_ASSIGN(locks.arm, hold_arm(script.host, script.port, holder));
    BITELINE_ASSIGN(locks.claim, claim_arm(*options.robot));
  }
  BITELINE_ASSIGN(
      std::unique_ptr<Cockpit> cockpit,
      Cockpit::open({.results = options.out,
                     .stock = stock_folders(options),
                     .sensor = options.sensor.text(),
                     .arm = robot ? robot->arm.name : "",
                     .controller = robot ? robot->options.script : "",
                     .rtde = robot ? robot->options.rtde : "",
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
    BITELINE_ASSIGN(confirm, read_confirm(options.out, robot->options.confirm, cockpit->memory()));
  }
  if (options.doors.guest) {
    BITELINE_ASSIGN(const std::string token, cockpit->accounts().make_guest_token());
    BITELINE_TRY(write_secret(*options.doors.guest, token + "\n"));
  }
  return Service{options,          std::move(keys),    std::move(robot),  std::move(carrier),
                 std::move(locks), std::move(cockpit), std::move(confirm)};
}

Service::Service(Options options, std::optional<wire::HostKeys> keys, std::optional<Robot> robot,
                 std::optional<Carrier> carrier, Locks locks, std::unique_ptr<Cockpit> cockpit,
                 std::optional<Confirm> confirm)
    : options_{std::move(options)},
      keys_{std::move(keys)},
      robot_{std::move(robot)},
      carrier_{std::move(carrier)},
      locks_{std::move(locks)},
      cockpit_{std::move(cockpit)},
      confirm_{std::move(confirm)} {}

Result<ExitStatus> Service::run(const std::atomic<bool>& stop) {
  stop_ = &stop;
  if (const Result<int> rows = take_up_rows(cockpit_->memory(), options_.out); !rows) complain(rows.error());
  if (cockpit_->has_doors()) say_step("doors come in at %s", cockpit_->address().c_str());
  BITELINE_TRY(watch_pendant());
  take_up_order();
  find_unfinished();
  forget_used_part();
  look_for_next_folder();
  while (!stop) {
    keep_web();
    heed_wishes();
    end_what_was_stopped();
    look_at_centre();
    if (!scan_ && !result_.valid() && !waits() && !unfinished_.empty()) {
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
      sensor_lost_ = to_line(heard.error());
      cockpit_->lose_sensor(sensor_lost_);
      // With the scan in, nobody waits for the sensor any more.
      const bool scan_in = scan_ && scan_->intake.ended();
      if (options_.once && !result_.valid() && !waits() && !scan_in)
        return tl::unexpected<Error>{heard.error()};
      complain(heard.error());
      wait_before_retry(stop);
    }
    start_result();
    if (const std::optional<Result<ExitStatus>> status = result_done()) {
      if (options_.once && !waits()) return *status;
      if (!*status) complain(status->error());
      rest_after(*status);
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

void Service::start_result() {
  if (!scan_ || !ready(*scan_) || result_.valid() || waits()) return;
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

}  // namespace biteline::service
