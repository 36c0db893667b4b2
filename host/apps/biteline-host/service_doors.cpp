// SPDX-License-Identifier: MIT
// What people wish at the doors, and what they are told; the page and the robot beside it.
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
  cockpit_->hinder(!robot_wrong_.empty() ? Hindrance::Robot : rest_ ? Hindrance::Rest : Hindrance::None);
  if (scan_) return show_scan(*scan_);
  if (after_) return cockpit_->show("looks at what was done to " + after_->name(), "what it tells");
  if (held_) {
    if (looks()) return cockpit_->show("looks whether " + held_->name() + " has moved", "a person decides");
    if (held_->planned() != nullptr)
      return cockpit_->show(
          held_->name() + " waits for a person" + (held_->look_words.empty() ? "" : ": " + held_->look_words),
          "accept it, reject it, or scan again");
    return cockpit_->show(held_->name() + " waits: its model is not known",
                          "choose its model, reject it, or scan again");
  }
  const CellMachine cell = cockpit_->cell();
  const bool waits_for_start = cell.going() == Going::WaitsForStart;
  if (cell.going() == Going::Stopped) {
    cockpit_->show("no scan is asked for", "start, when the cell is clear");
  } else if (cell.sensing() == Sensing::Starting || cell.sensing() == Sensing::Away) {
    cockpit_->show(sensor_lost_.empty() ? "no sensor" : sensor_lost_, "it is called again each second");
  } else if (!robot_wrong_.empty()) {
    cockpit_->show("the robot is not ready: " + robot_wrong_, "the next scan, once it is");
  } else if (rest_) {
    cockpit_->show((waits_for_start ? "waits for a start: " : "") + rest_->words, rest_->next_step);
  } else if (waits_for_start && !asks_.empty()) {
    cockpit_->show("a person must look: " + asks_, "look at the shoe, then start");
  } else if (waits_for_start) {
    cockpit_->show("waits for a start", "one scan for each start");
  } else {
    cockpit_->show("waits for the sensor", "the next scan");
  }
}

void Service::show_scan(const Scan& scan) {
  const bool look = scan.look && held_, after_work = scan.after_work && after_;
  const std::string comes = look         ? "looks whether " + held_->name() + " has moved"
                            : after_work ? "looks at what was done to " + after_->name()
                                         : scan.folder.filename().string() + " comes in";
  if (scan.profiles_at_trouble && *scan.profiles_at_trouble >= scan.intake.profiles())
    return cockpit_->show(comes + ": " + scan.trouble, "it goes on once that is mended; stop ends it");
  cockpit_->show(comes, look ? "a person decides" : after_work ? "what it tells" : "its line");
}

void Service::tell_held(const HeldScan& held, bool again) {
  Cockpit::HeldShown shown{.scan = held.name(), .waits = Waits::ForModel, .mark = held.scan.mark};
  if (const Planned* const planned = held.planned()) {
    const bool has_path = planned->plan.outcome.path.has_value();
    shown.waits = has_path ? Waits::ForWord : Waits::ForPath;
    shown.version = version_of(held.scan.folder, held.scan.chosen.written);
    if (has_path) {
      shown.not_sendable = why_not_sendable(held.scan.folder, planned->plan, planned->request);
      shown.fresh_s = fresh_s(planned->plan, planned->request);
    }
  }
  if (again) return cockpit_->hold_on(shown);
  cockpit_->hold(shown);
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
    const std::string words = "biteline-web has ended: " + web_->last_words() + "; it is started again";
    const ToldOnce::Heard heard = told_.hear(words, now());
    if (heard.tells) say_step("%s", with_count(words, heard).c_str());
    // One that has run for long is started at once.
    web_next_ = std::min(now() + heard.wait, web_started_ + k_web_is_well);
    web_.reset();
  }
  if (now() < web_next_) return;
  web_started_ = now();
  web_next_ = web_started_ + k_between_looks;
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
  // What is held belongs to the result's thread until that has ended; a word may come before.
  while (const std::optional<Wish> wish = cockpit_->next_wish(!result_.valid())) heed(*wish);
}

void Service::heed(const Wish& wish) {
  // What was said before a stop is over.
  if (wish.ends_by_stop() && wish.mark.stopped()) return cockpit_->drop(wish);
  switch (wish.kind) {
    case Wish::Kind::Stop:
    case Wish::Kind::LaserOff:
      say_step("%s by %s", wish.kind == Wish::Kind::Stop ? "stopped" : "laser off", wish.who.c_str());
      // A scan of a start that came after it goes on.
      if ((scan_ && !scan_->mark.stopped()) || (asked_ && !asked_->stopped())) return;
      if (scan_ && !scan_->ended && scan_->stopped_by.empty()) {
        // What there is of it is no shoe to be judged, also for a service after this one.
        scan_->stopped_by = wish.who;
        if (const Result<void> marked = mark_stopped(scan_->folder, wish.who); !marked)
          complain(marked.error());
      }
      if (link_) {
        link_->command(
            {.id = k_stop_id,
             .command = wish.kind == Wish::Kind::Stop ? wire::Command::StopScan : wire::Command::LaserOff});
      }
      return;
    case Wish::Kind::Start:
    case Wish::Kind::Rescan:
      say_step("%s by %s", wish.kind == Wish::Kind::Start ? "started" : "scanned again", wish.who.c_str());
      if (wish.kind == Wish::Kind::Start) order_by(wish);
      if (wish.kind == Wish::Kind::Rescan) order_part_again(wish);
      // Whoever says so has looked: at once, and told anew.
      rest_.reset();
      spoilt_.mended();
      if (!std::exchange(asks_, {}).empty()) keep_asking({});
      return;
    case Wish::Kind::Reject:
      if (std::optional<HeldScan> held = take_held(wish)) {
        say_step("%s is rejected by %s", wish.scan.c_str(), wish.who.c_str());
        end_recording(held->scan.intake, ExitStatus::Refused);
        if (const std::string words = leave_step(held->scan); !words.empty()) asks_ = words;
      }
      return;
    case Wish::Kind::Send:
    case Wish::Kind::Model:
    case Wish::Kind::Mended:
    case Wish::Kind::Process:
    case Wish::Kind::Air:
    case Wish::Kind::Look:
      if (std::optional<HeldScan> held = take_held(wish)) go_on(wish, std::move(*held));
      return;
    case Wish::Kind::Settings:
      if (!sensor_hears())
        return cockpit_->answer_sensor(wish.question, fail(Errc::WrongState, "no sensor is connected"));
      say_step("settings are changed by %s", wish.who.c_str());
      link_->command({.id = wish.question, .command = wire::Command::UseSettings, .settings = wish.settings});
      return;
    case Wish::Kind::Keep:
      if (!sensor_hears())
        return cockpit_->answer_sensor(wish.question, fail(Errc::WrongState, "no sensor is connected"));
      say_step("a recording is asked for by %s", wish.who.c_str());
      link_->command({.id = wish.question, .command = wish.command});
      return;
    case Wish::Kind::Saved:
      return order_is_saved(wish);
    case Wish::Kind::Hold:
      return;
  }
}

Result<void> Service::watch_pendant() {
  // By the generic protocol nobody can be asked.
  if (!robot_ || !robot_->options.send || locks_.other) return {};
  BITELINE_ASSIGN(const robot::ur::DoorPlaces doors, doors_of(controller()));
  pendant_ = std::make_unique<robot::ur::PendantWatch>(
      robot::ur::PendantWatch::Config{.doors = doors},
      [cockpit = cockpit_.get()] { cockpit->taken_at_the_pendant(); });
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
  cockpit_->hear(look.words, look.wrong);
  if (robot_wrong_.empty()) return true;
  const std::string words = "no scan is spent: " + robot_wrong_;
  const ToldOnce::Heard heard = told_.hear(words, robot_asked_);
  if (heard.tells) say_step("%s", with_count(words, heard).c_str());
  return false;
}

}  // namespace biteline::service
