// SPDX-License-Identifier: MIT
// What people command at the doors, and what they are told; the page and the robot beside it.
#include <pthread.h>

#include <utility>

#include "host/apps/biteline-host/attempt.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/records/digest/digest.hpp"

namespace biteline::service {
namespace {

using std::chrono::milliseconds;

/// A robot that is not ready, or a page that ended, is looked at again.
constexpr Nanoseconds k_between_looks = milliseconds{2000};
/// A page that has run for so long came up well.
constexpr Nanoseconds k_web_is_well = std::chrono::minutes{1};

/// Of what a page shows of a scan that waits: a yes to another one is none.
std::string version_of(const std::filesystem::path& folder, const memory::Evidence& written) {
  Digest version;
  version.add_text(written.line).add_text(written.cloud).add_text(written.process);
  return version.add_text(digest_of_file(folder / "path/path.csv").value_or("")).hex().substr(0, 16);
}

}  // namespace

void Service::show_idle() {
  // While a result is worked out, its thread says what goes on.
  if (result_.valid()) return;
  if (!held_) show_next_process();
  operator_control_->hinder(!robot_wrong_.empty() ? Hindrance::Robot
                            : rest_               ? Hindrance::Rest
                                                  : Hindrance::None);
  if (scan_) return show_scan(*scan_);
  if (after_) return operator_control_->show("looks at what was done to " + after_->name(), "what it tells");
  if (held_) {
    if (looks())
      return operator_control_->show("looks whether " + held_->name() + " has moved", "a person decides");
    if (held_->planned() != nullptr)
      return operator_control_->show(
          held_->name() + " waits for a person" + (held_->look_words.empty() ? "" : ": " + held_->look_words),
          "accept it, reject it, or scan again");
    return operator_control_->show(held_->name() + " waits: its model is not known",
                                   "choose its model, reject it, or scan again");
  }
  const CellMachine cell = operator_control_->cell();
  const bool waits_for_start = cell.going() == Going::WaitsForStart;
  if (cell.going() == Going::Stopped) {
    operator_control_->show("no scan is asked for", "start, when the cell is clear");
  } else if (cell.sensing() == Sensing::Starting || cell.sensing() == Sensing::Away) {
    operator_control_->show(sensor_lost_.empty() ? "no sensor" : sensor_lost_,
                            "it is called again each second");
  } else if (!robot_wrong_.empty()) {
    operator_control_->show("the robot is not ready: " + robot_wrong_, "the next scan, once it is");
  } else if (rest_) {
    operator_control_->show((waits_for_start ? "waits for a start: " : "") + rest_->words, rest_->next_step);
  } else if (waits_for_start && !asks_.empty()) {
    operator_control_->show("a person must look: " + asks_, "look at the shoe, then start");
  } else if (waits_for_start) {
    operator_control_->show("waits for a start", "one scan for each start");
  } else {
    operator_control_->show("waits for the sensor", "the next scan");
  }
}

void Service::show_scan(const Scan& scan) {
  const bool look = scan.look && held_, after_work = scan.after_work && after_;
  const std::string comes = look         ? "looks whether " + held_->name() + " has moved"
                            : after_work ? "looks at what was done to " + after_->name()
                                         : scan.folder.filename().string() + " comes in";
  if (scan.profiles_at_trouble && *scan.profiles_at_trouble >= scan.intake.profiles())
    return operator_control_->show(comes + ": " + scan.trouble,
                                   "it goes on once that is mended; stop ends it");
  operator_control_->show(comes, look ? "a person decides" : after_work ? "what it tells" : "its line");
}

void Service::tell_held(const HeldScan& held, bool again) {
  OperatorControl::HeldShown shown{.scan = held.name(),
                                   .waits = Waits::ForModel,
                                   .mark = held.scan.mark,
                                   .is_step = !held.scan.chosen.follows.empty()};
  if (const Planned* const planned = held.planned()) {
    const bool has_path = planned->plan.outcome.path.has_value();
    shown.waits = has_path ? Waits::ForWord : Waits::ForPath;
    shown.version = version_of(held.scan.folder, held.scan.chosen.written);
    const path::Process& process = planned->plan.request.process;
    if (path::waits_for_its_tool(process, planned->request.mounted)) shown.tool = process.tool.name;
    if (has_path) {
      shown.not_sendable = why_not_sendable(held.scan.folder, planned->plan, planned->request);
      shown.fresh_s = fresh_s(planned->plan, planned->request);
    }
  }
  if (again) return operator_control_->hold_on(shown);
  operator_control_->hold(shown);
}

void Service::supervise_web() {
  if (!options_.doors.web) return;
  // Its words, without waiting for any: the sensor must hear this thread.
  while (web_) {
    const Result<std::string> line = web_->next_line(milliseconds{0});
    if (!line) break;
    log_step("%s", line->c_str());
  }
  if (web_ && web_->running()) return;
  if (web_) {
    const std::string words = "biteline-web has ended: " + web_->last_words() + "; it is started again";
    const ToldOnce::Heard heard = told_.hear(words, now());
    if (heard.tells) log_step("%s", with_count(words, heard).c_str());
    // One that has run for long is started at once.
    web_next_ = std::min(now() + heard.wait, web_started_ + k_web_is_well);
    web_.reset();
  }
  if (now() < web_next_) return;
  web_started_ = now();
  web_next_ = web_started_ + k_between_looks;
  std::vector<std::string> arguments{"--control", operator_control_->address(), "--exit-with-parent"};
  if (!options_.doors.web_address.empty())
    arguments.insert(arguments.end(), {"--listen", options_.doors.web_address});
  auto web = intake::ChildProcess::start({.program = intake::program_folder() / "biteline-web",
                                          .arguments = std::move(arguments),
                                          .pass_stderr = true});
  if (!web) return log_error(web.error());
  web_.emplace(std::move(*web));
}

void Service::heed_wishes() {
  // What is held belongs to the result's thread until that has ended; a word may come before.
  while (const std::optional<OperatorCommand> command = operator_control_->next_command(!result_.valid()))
    handle(*command);
}

void Service::handle(const OperatorCommand& command) {
  // What was said before a stop is over.
  if (command.ends_by_stop() && command.mark.stopped()) return operator_control_->drop(command);
  switch (command.kind) {
    case OperatorCommand::Kind::Stop:
    case OperatorCommand::Kind::LaserOff:
      log_step("%s by %s", command.kind == OperatorCommand::Kind::Stop ? "stopped" : "laser off",
               command.who.c_str());
      // A scan of a start that came after it goes on.
      if ((scan_ && !scan_->mark.stopped()) || (asked_ && !asked_->stopped())) return;
      if (scan_ && !scan_->ended && scan_->stopped_by.empty()) {
        // What there is of it is no shoe to be judged, also for a service after this one.
        scan_->stopped_by = command.who;
        if (const Result<void> marked = mark_stopped(scan_->folder, command.who); !marked)
          log_error(marked.error());
      }
      if (link_) {
        link_->command({.id = k_stop_id,
                        .command = command.kind == OperatorCommand::Kind::Stop ? wire::Command::StopScan
                                                                               : wire::Command::LaserOff});
      }
      return;
    case OperatorCommand::Kind::Start:
    case OperatorCommand::Kind::Rescan:
      log_step("%s by %s", command.kind == OperatorCommand::Kind::Start ? "started" : "scanned again",
               command.who.c_str());
      if (command.kind == OperatorCommand::Kind::Start) order_by(command);
      if (command.kind == OperatorCommand::Kind::Rescan) order_part_again(command);
      // Whoever says so has looked: at once, and told anew.
      rest_.reset();
      spoilt_.mended();
      if (!std::exchange(asks_, {}).empty()) keep_asking({});
      return;
    case OperatorCommand::Kind::Reject:
      if (std::optional<HeldScan> held = take_held(command)) {
        log_step("%s is rejected by %s", command.scan.c_str(), command.who.c_str());
        end_recording(held->scan.intake, ExitStatus::Refused);
        if (const std::string words = leave_step(held->scan); !words.empty()) asks_ = words;
      }
      return;
    case OperatorCommand::Kind::Send:
    case OperatorCommand::Kind::Model:
    case OperatorCommand::Kind::Mended:
    case OperatorCommand::Kind::Process:
    case OperatorCommand::Kind::Air:
    case OperatorCommand::Kind::Look:
      if (std::optional<HeldScan> held = take_held(command)) go_on(command, std::move(*held));
      return;
    case OperatorCommand::Kind::Settings:
      if (!sensor_hears())
        return operator_control_->answer_sensor(command.question,
                                                fail(Errc::WrongState, "no sensor is connected"));
      log_step("settings are changed by %s", command.who.c_str());
      link_->command(
          {.id = command.question, .command = wire::Command::UseSettings, .settings = command.settings});
      return;
    case OperatorCommand::Kind::Keep:
      if (!sensor_hears())
        return operator_control_->answer_sensor(command.question,
                                                fail(Errc::WrongState, "no sensor is connected"));
      log_step("a recording is asked for by %s", command.who.c_str());
      link_->command({.id = command.question, .command = command.command});
      return;
    case OperatorCommand::Kind::Saved:
      return order_is_saved(command);
    case OperatorCommand::Kind::Hold:
      return;
  }
}

Result<void> Service::watch_pendant() {
  // By the generic protocol nobody can be asked.
  if (!robot_ || !robot_->options.send || locks_.other) return {};
  BITELINE_ASSIGN(const robot::ur::DoorPlaces doors, doors_of(controller()));
  pendant_ = std::make_unique<robot::ur::PendantWatch>(
      robot::ur::PendantWatch::Config{.doors = doors},
      [operator_control = operator_control_.get()] { operator_control->taken_at_the_pendant(); });
  return {};
}

Result<void> Service::watch_clamp() {
  if (!robot_ || !robot_->options.send || !robot_->options.clamp_input) return {};
  BITELINE_ASSIGN(const HostPort rtde, parse_host_port(robot_->options.rtde));
  clamp_ = std::make_unique<robot::ur::ClampWatch>(robot::ur::ClampWatch::Config{
      .host = rtde.host, .rtde_port = rtde.port, .input = *robot_->options.clamp_input});
  return {};
}

bool Service::robot_ready() {
  if (!robot_ || !robot_->options.send) return true;
  if (!robot_wrong_.empty() && now() - robot_asked_ < k_between_looks) return false;
  const ControllerLook look = look_at_controller(controller(), robot_->arm, robot_->options.serial);
  robot_asked_ = now();
  robot_wrong_ = look.wrong;
  robot_moves_ = look.moves;
  operator_control_->hear(look.words, look.wrong);
  if (robot_wrong_.empty()) return true;
  const std::string words = "no scan is spent: " + robot_wrong_;
  const ToldOnce::Heard heard = told_.hear(words, robot_asked_);
  if (heard.tells) log_step("%s", with_count(words, heard).c_str());
  return false;
}

}  // namespace biteline::service
