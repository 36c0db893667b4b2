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
  // While a result is worked out, what is held belongs to its thread.
  if (result_.valid()) return;
  if (!waits()) show_next_process();
  if (waits() && !told_held_) {
    tell_held();
    cockpit_->tell_scan((held_ ? held_->folder : unnamed_->scan.folder).filename().string());
  }
  if (held_) {
    cockpit_->show(Phase::Deciding, held_->folder.filename().string() + " waits for a person",
                   "accept it, reject it, or scan again");
    return;
  }
  if (unnamed_) {
    const std::string name = unnamed_->scan.folder.filename().string();
    cockpit_->show(Phase::Deciding, name + " waits: its model is not known",
                   "choose its model, reject it, or scan again");
    return;
  }
  if (scan_) return;
  const bool waits_for_start = cockpit_->paused() && cockpit_->waits_for_start();
  if (cockpit_->paused() && !waits_for_start) {
    cockpit_->show(Phase::Stopped, "no scan is asked for", "start, when the cell is clear");
  } else if (!sensor_heard_) {
    cockpit_->show(Phase::Fault, sensor_lost_.empty() ? "no sensor" : sensor_lost_,
                   "it is called again each second");
  } else if (!robot_wrong_.empty()) {
    cockpit_->show(Phase::Fault, "the robot is not ready: " + robot_wrong_, "the next scan, once it is");
  } else if (rest_ && waits_for_start) {
    // A fault would take no start.
    cockpit_->show(Phase::Waiting, "waits for a start: " + rest_->words, rest_->next_step);
  } else if (rest_) {
    cockpit_->show(Phase::Fault, rest_->words, rest_->next_step);
  } else if (waits_for_start) {
    cockpit_->show(Phase::Waiting, "waits for a start", "one scan for each start");
  } else {
    cockpit_->show(Phase::Waiting, "waits for the sensor", "the next scan");
  }
}

void Service::tell_held() {
  if (held_) {
    const std::optional<HostClock::time_point> ended = held_->request.scan_ended;
    std::optional<double> fresh_s;
    std::optional<report::ToldRefusal> why_not;
    if (held_->plan.outcome.path) why_not = why_not_sendable(held_->folder, held_->plan, held_->request);
    // Who vouches for a scan vouches for its age.
    if (ended && held_->plan.outcome.path && !held_->request.scan.confirmed) {
      const double age_s = 1e-9 * static_cast<double>((now() - *ended).count());
      fresh_s = held_->plan.request.process.gate.scan_age_s - age_s;
    }
    cockpit_->hold(held_->folder.filename().string(),
                   held_->plan.outcome.path ? Cockpit::Wait::Word : Cockpit::Wait::Mend, fresh_s,
                   held_->request.mark, why_not, version_of(held_->folder, held_->chosen.written));
  } else {
    cockpit_->hold(unnamed_->scan.folder.filename().string(), Cockpit::Wait::Model, {}, unnamed_->scan.mark);
  }
  told_held_ = true;
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
  while (const std::optional<Wish> wish = cockpit_->next_wish()) {
    // What is held belongs to the result's thread until that has ended; a word may come before.
    const bool of_held = wish->kind == Wish::Kind::Send || wish->kind == Wish::Kind::Reject ||
                         wish->kind == Wish::Kind::Model || wish->kind == Wish::Kind::Mended ||
                         wish->kind == Wish::Kind::Process || wish->kind == Wish::Kind::Air;
    if (of_held && result_.valid()) {
      later_.push_back(*wish);
    } else {
      heed(*wish);
    }
  }
  if (result_.valid()) return;
  for (const Wish& wish : std::exchange(later_, {})) heed(wish);
}

void Service::end_what_was_stopped() {
  if (result_.valid() || !waits()) return;
  const robot::StopMark& mark = held_ ? held_->request.mark : unnamed_->scan.mark;
  // A line that is being mended is a whole one when its row is written.
  if (!mark.stopped() || cockpit_->mends((held_ ? held_->folder : unnamed_->scan.folder).filename().string()))
    return;
  told_held_ = false;
  // Not here: the memory may be slow, and the sensor must hear this thread.
  result_ = std::async(std::launch::async, [this, held = std::exchange(held_, {}),
                                            unnamed = std::exchange(unnamed_, {})]() mutable {
    pthread_setname_np(pthread_self(), "bl-result");
    const std::filesystem::path folder = held ? held->folder : unnamed->scan.folder;
    say_step("%s waits no longer: it was stopped", folder.filename().c_str());
    end_recording(held ? held->intake : unnamed->scan.intake, ExitStatus::Refused);
    remember(folder, "open", held ? held->chosen : unnamed->scan.chosen, {.stopped = true});
    return Result<ExitStatus>{ExitStatus::Refused};
  });
}

template <class Work>
void Service::go_on_with_held(const Wish& wish, const char* words, Work work) {
  if (result_.valid() || !held_ || held_->folder.filename() != wish.scan) return;
  if (held_->request.mark.stopped()) return;
  say_step("%s %s by %s", wish.scan.c_str(), words, wish.who.c_str());
  told_held_ = false;
  result_ = std::async(std::launch::async, [held = std::move(*held_), work = std::move(work)]() mutable {
    pthread_setname_np(pthread_self(), "bl-result");
    return work(std::move(held));
  });
  held_.reset();
}

void Service::heed(const Wish& wish) {
  // What was said before a stop is over.
  const bool of_person = wish.kind != Wish::Kind::Stop && wish.kind != Wish::Kind::LaserOff &&
                         wish.kind != Wish::Kind::Settings && wish.kind != Wish::Kind::Keep &&
                         wish.kind != Wish::Kind::Saved;
  if (of_person && wish.mark.stopped()) return cockpit_->drop(wish);
  switch (wish.kind) {
    case Wish::Kind::Stop:
    case Wish::Kind::LaserOff:
      say_step("%s by %s", wish.kind == Wish::Kind::Stop ? "stopped" : "laser off", wish.who.c_str());
      // A scan of a start that came after it goes on.
      if ((scan_ && !scan_->mark.stopped()) || (asked_ && !asked_->mark.stopped())) return;
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
      // What a stop cut short is over; an idle sensor is asked.
      if (link_ && !scan_ && !result_.valid()) sensor_idle_ = true;
      return;
    case Wish::Kind::Model:
      if (result_.valid() || !unnamed_ || unnamed_->scan.mark.stopped() ||
          unnamed_->scan.folder.filename() != wish.scan)
        return;
      say_step("%s is named %s by %s", wish.scan.c_str(), wish.job.model.c_str(), wish.who.c_str());
      told_held_ = false;
      result_ = std::async(std::launch::async,
                           [this, unnamed = std::move(*unnamed_), model = wish.job.model]() mutable {
                             pthread_setname_np(pthread_self(), "bl-result");
                             return work_named(std::move(unnamed), model);
                           });
      unnamed_.reset();
      return;
    case Wish::Kind::Reject:
      if (!result_.valid() && unnamed_ && unnamed_->scan.folder.filename() == wish.scan) {
        say_step("%s is rejected by %s", wish.scan.c_str(), wish.who.c_str());
        told_held_ = false;
        end_recording(unnamed_->scan.intake, ExitStatus::Refused);
        unnamed_.reset();
        return;
      }
      [[fallthrough]];
    case Wish::Kind::Send:
      if (wish.kind == Wish::Kind::Reject) {
        if (result_.valid() || !held_ || held_->folder.filename() != wish.scan) return;
        told_held_ = false;
        say_step("%s is rejected by %s", wish.scan.c_str(), wish.who.c_str());
        end_recording(held_->intake, ExitStatus::Refused);
        held_.reset();
        return;
      }
      return go_on_with_held(wish, "is accepted",
                             [this, word = robot::Word{.by = wish.who, .at = utc_now()}](Held held) {
                               return send_held(std::move(held), word);
                             });
    case Wish::Kind::Mended:
      return go_on_with_held(wish, "has its line mended",
                             [this](Held held) { return plan_mended(std::move(held)); });
    case Wish::Kind::Air:
      return go_on_with_held(wish, "is run in the air",
                             [this, word = robot::Word{.by = wish.who, .at = utc_now()}](Held held) {
                               return run_in_air(std::move(held), word);
                             });
    case Wish::Kind::Process:
      if (!unnamed_) {
        return go_on_with_held(wish, "gets another process",
                               [this, process = wish.job.process, who = wish.who](Held held) {
                                 return plan_with(std::move(held), process, who);
                               });
      }
      if (result_.valid() || unnamed_->scan.mark.stopped() || unnamed_->scan.folder.filename() != wish.scan)
        return;
      say_step("%s goes on with %s by %s", wish.scan.c_str(), wish.job.process.c_str(), wish.who.c_str());
      told_held_ = false;
      result_ = std::async(std::launch::async, [this, unnamed = std::move(*unnamed_),
                                                process = wish.job.process, who = wish.who]() mutable {
        pthread_setname_np(pthread_self(), "bl-result");
        return work_with(std::move(unnamed), process, who);
      });
      unnamed_.reset();
      return;
    case Wish::Kind::Settings:
      if (!link_ || !sensor_heard_)
        return cockpit_->answer_sensor(wish.question, fail(Errc::WrongState, "no sensor is connected"));
      say_step("settings are changed by %s", wish.who.c_str());
      link_->command({.id = wish.question, .command = wire::Command::UseSettings, .settings = wish.settings});
      return;
    case Wish::Kind::Keep:
      if (!link_ || !sensor_heard_)
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
  if (!robot_ || !robot_->options.send) return {};
  BITELINE_ASSIGN(const robot::ur::Endpoint dashboard, dashboard_of(controller_of(robot_->options)));
  pendant_ = std::make_unique<robot::ur::PendantWatch>(
      robot::ur::PendantWatch::Config{.dashboard = dashboard},
      [cockpit = cockpit_.get()] { cockpit->taken_at_the_pendant(); });
  return {};
}

bool Service::robot_ready() {
  if (!robot_ || !robot_->options.send) return true;
  if (!robot_wrong_.empty() && now() - robot_asked_ < k_between_looks) return false;
  const ControllerLook look =
      look_at_controller(controller_of(robot_->options), robot_->arm.name, robot_->options.serial);
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
