// SPDX-License-Identifier: MIT
// What the sensor says, and the scans that come in.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "host/apps/biteline-host/attempt.hpp"
#include "host/apps/biteline-host/part.hpp"
#include "host/apps/biteline-host/scan_row.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/report/report.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr Nanoseconds k_turn = milliseconds{100};
/// While a result is being worked out: nobody shall wait for it longer than this after it is done.
constexpr Nanoseconds k_wait = milliseconds{5};
/// A sensor tells its state a few times a second: so long the last word about the light is waited for.
constexpr Nanoseconds k_last_health = milliseconds{1000};
/// Who said stop where its word has not been worked off yet.
constexpr const char* k_somebody = "a person";

}  // namespace

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
    if (links_++ > 0) operator_control_->enter(CellEvent::Lost);
  }
  // The next scan only once the arm is out of its way, and what was left of earlier ones is done.
  const bool next_scan = is_free() && unfinished_.empty() && !rests();
  if (operator_control_->cell().may_ask() && !scan_ && cut_off_.empty() &&
      (next_scan || looks() || inspects())) {
    // A robot that is not ready would cost a scan that nobody can use.
    if (!robot_ready()) {
      // A start that takes effect whenever somebody mends the robot would surprise him.
      if (!robot_moves_ && looks()) give_up_look("the robot is not ready: " + robot_wrong_);
      if (!robot_moves_ && !inspects()) operator_control_->give_up_start();
      if (options_.once && !robot_moves_)
        return fail(Errc::DeviceError, "robot %s: it is not ready", robot_->options.script.c_str());
      BITELINE_ASSIGN(const std::optional<intake::LinkEvent> meanwhile, link_->next(k_turn));
      if (meanwhile) BITELINE_TRY(on_event(*meanwhile));
      return {};
    }
    // A stop that came while the robot was asked is one.
    const std::optional<robot::StopMark> mark = looks()      ? held_->scan.mark
                                                : inspects() ? after_->scan.mark
                                                             : operator_control_->begin_cycle();
    if (mark && !mark->stopped()) {
      operator_control_->enter(CellEvent::Asks);
      // Before the light, which may come before the scan does.
      log_step("asks for a scan");
      // Should the scan that was asked for before begin after all, it is as old as that.
      asked_ = asked_.value_or(*mark);
      link_->command({.id = k_start_id, .command = wire::Command::StartScan});
    }
  }
  BITELINE_ASSIGN(const std::optional<intake::LinkEvent> event,
                  link_->next(result_.valid() ? k_wait : k_turn));
  if (event) BITELINE_TRY(on_event(*event));
  return {};
}

Result<void> Service::on_event(const intake::LinkEvent& event) {
  if (const auto* hello = std::get_if<intake::Hello>(&event)) {
    sensor_lost_.clear();
    operator_control_->hear(hello->sensor);
    return on_hello(*hello);
  }
  if (const auto* health = std::get_if<wire::Health>(&event)) operator_control_->hear(*health);
  if (const auto* reply = std::get_if<wire::ControlReply>(&event)) {
    if (reply->id > k_last_own_id) {
      Result<std::string> done = reply->where;
      if (reply->errc != 0) done = fail(Errc::PeerRefused, "%s", reply->where.c_str());
      operator_control_->answer_sensor(reply->id, done);
      return {};
    }
    if (reply->errc == 0 || reply->id != k_start_id) return {};
    return on_refused_start(reply->where);
  }
  if (!scan_) return {};  // the rest of a scan that was over before this host came
  const std::size_t before = scan_->intake.cloud().size();
  BITELINE_TRY(scan_->intake.take(event, link_->packet()));
  operator_control_->show_progress(scan_->intake.profiles(), scan_->intake.profiles_expected());
  if (scan_->intake.ended() && !scan_->ended) {
    scan_->ended = now();
    if (scan_->stopped_by.empty() && scan_->mark.stopped()) scan_->stopped_by = k_somebody;
    scan_->one_connection = !scan_->recovered && scan_->connection == connection();
  }
  link_->acknowledge();
  if (const auto* profile = std::get_if<intake::ProfileEvent>(&event); profile && scan_->line) {
    const cloud::PointCloud& cloud = scan_->intake.cloud();
    scan_->line->add_profile(profile->profile.header.sequence, std::span{cloud.points}.subspan(before),
                             intake::pose_of(profile->profile.header),
                             cloud.stripe(before, cloud.size() - before));
  }
  return {};
}

Result<void> Service::on_hello(const intake::Hello& hello) {
  if (scan_ && !hello.resumed) {
    // What there is of it is kept and told; it is not a result.
    log_step("the sensor no longer has the rest of %s", scan_->folder.filename().c_str());
    Scan cut_off = std::move(*scan_);
    if (cut_off.stopped_by.empty() && cut_off.mark.stopped()) cut_off.stopped_by = k_somebody;
    scan_.reset();
    cut_off_.push_back(std::move(cut_off));
    operator_control_->enter(CellEvent::ScanIsIn);
  }
  if (scan_) {
    const std::uint64_t at = scan_->intake.profiles();
    if (std::exchange(scan_->went_on_at, at) != at)
      log_step("goes on with %s at profile %llu", scan_->folder.filename().c_str(),
               static_cast<unsigned long long>(at));
    return {};
  }
  const bool has_scan = hello.scan_id != 0 && (hello.sensor.scanning || hello.sensor.lossless);
  if (!has_scan) {
    log_step("connected to %s%s", hello.sensor.name.c_str(), hello.sensor.simulated ? " (simulated)" : "");
    operator_control_->enter(CellEvent::Heard);
    asked_.reset();
    return {};
  }
  if (looks()) return begin_look(hello);
  if (inspects()) return begin_inspection(hello);
  const fs::path folder = take_next_folder();
  BITELINE_TRY(report::prepare_folder(folder));
  look_for_next_folder();
  BITELINE_ASSIGN(intake::ScanIntake intake, intake::ScanIntake::begin(folder, hello, link_->packet()));
  hold_scan(folder, std::move(intake));
  take_part();
  log_step("takes in scan '%s' of %s%s into %s", hello.sensor.scan_name.c_str(), hello.sensor.name.c_str(),
           hello.sensor.simulated ? " (simulated)" : "", folder.c_str());
  return {};
}

Result<void> Service::on_refused_start(const std::string& why) {
  asked_.reset();
  if (inspects()) {
    operator_control_->enter(CellEvent::Refuses);
    give_up_inspection("the sensor does not begin: " + why);
    return {};
  }
  const Result<void> no = fail(Errc::PeerRefused, "the sensor does not begin a scan: %s", why.c_str());
  if (options_.once) return no;
  log_error(no.error());
  if (looks()) {
    operator_control_->enter(CellEvent::Refuses);
    give_up_look("the sensor does not begin: " + why);
    return {};
  }
  // It is there and says why: the link stays.
  operator_control_->give_up_start();
  operator_control_->enter(CellEvent::Refuses);
  rest("the sensor does not begin a scan: " + why, "mend what it names");
  return {};
}

void Service::rest_after(const Worked& worked) {
  LastEnd end = worked.end;
  if (held_ || after_ || end.who == report::EndedBy::Person) return;
  if (const Result<ExitStatus>& status = worked.status; !status) {
    end.who = report::EndedBy::Machine;
    if (end.told.reason.empty())
      end.told = {.reason_code = {},
                  .reason = to_line(status.error()),
                  .next_step = error_row(status.error().code).action};
  }
  // What a shoe is refused for says nothing against the next scan.
  if (end.who != report::EndedBy::Machine) return spoilt_.mended();
  rest(end.told.reason, end.told.next_step);
}

void Service::rest(const std::string& words, const std::string& next_step) {
  const ToldOnce::Heard heard = spoilt_.hear(words, now());
  const bool by_itself = !operator_control_->on_demand();
  const auto wait_s =
      static_cast<int>((heard.wait + std::chrono::milliseconds{999}) / std::chrono::seconds{1});
  rest_ = Rest{.until = now() + heard.wait, .words = words, .next_step = next_step};
  if (by_itself) {
    rest_->next_step += "; the next scan after " + std::to_string(wait_s) + " s" +
                        (operator_control_->has_doors() ? ", or by a start" : "");
  }
  if (heard.tells) log_step("%s", with_count(rest_->next_step, heard).c_str());
}

bool Service::rests() {
  // Where each scan has its own start, somebody has said it.
  if (rest_ && !operator_control_->on_demand() && now() >= rest_->until) rest_.reset();
  return rest_ && !operator_control_->on_demand();
}

void Service::hold_scan(const fs::path& folder, intake::ScanIntake intake) {
  rest_.reset();
  operator_control_->scan_begins(folder.filename().string());
  operator_control_->show(folder.filename().string() + " comes in", "its line");
  scan_.emplace(Scan{.folder = folder, .intake = std::move(intake), .line = {}, .connection = connection()});
  scan_->mark = asked_.value_or(operator_control_->going());
  asked_.reset();
  if (carrier_) return;
  scan_->line = std::make_unique<intake::LiveLine>(bite_line::Config{});
  scan_->line->add_profiles(scan_->intake.cloud(), scan_->intake.poses());
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
    return set_scan_aside(folder, "an earlier run of this service died while it worked it out");
  BITELINE_TRY(mark_attempt(folder));
  Result<intake::ScanIntake> intake = intake::ScanIntake::recover(folder);
  clear_attempt(folder);
  if (!intake) {
    // Another program has it open, or the disk fails: it is looked at again.
    const Errc code = intake.error().code;
    if (code == Errc::PeerRefused || code == Errc::DiskFull || code == Errc::WriteFailed)
      return tl::unexpected<Error>{intake.error()};
    return set_scan_aside(folder, to_line(intake.error()));
  }
  const std::optional<robot::Word> word = take_word(folder, intake->scan_id());
  log_step("found %s unfinished, with %llu profiles", folder.filename().c_str(),
           static_cast<unsigned long long>(intake->profiles()));
  hold_scan(folder, std::move(*intake));
  scan_->recovered = true;
  scan_->chosen.part = marked_part(folder);
  operator_control_->show_shoe({.part = scan_->chosen.part});
  scan_->confirmed = word;
  scan_->stopped_by = stopped_by(folder);
  // A connection made before would go on with another scan; the next one asks for the rest of this.
  if (!scan_->intake.ended()) link_.reset();
  return {};
}

Result<void> Service::set_scan_aside(const fs::path& folder, const std::string& why) {
  BITELINE_TRY(set_aside(folder, why));
  BITELINE_TRY(take_up_rows(operator_control_->memory(), options_.out));
  operator_control_->tell_scan(folder.filename().string());
  return {};
}

bool Service::confirmed(const fs::path& folder) const {
  return confirm_ && folder.filename() == confirm_->name;
}

std::optional<robot::Word> Service::take_word(const fs::path& folder, std::uint64_t scan_id) {
  if (!confirmed(folder) || scan_id != confirm_->scan_id) return std::nullopt;
  const Result<robot::Word> word = use_up(*confirm_, operator_control_->memory());
  confirm_.reset();
  if (word) return *word;
  log_error(word.error());
  return std::nullopt;
}

fs::path Service::next_folder() const {
  // Not a name that the memory knows: its folder may be gone, its row stays.
  int number = 1;
  memory::ScanFilter last;
  last.limit = 1;
  if (const Result<memory::ScanPage> newest = operator_control_->memory().scans(last);
      newest && !newest->scans.empty())
    number = 1 + std::atoi(newest->scans.front().name.c_str() + std::strlen("scan-"));
  std::error_code error;
  for (;; ++number) {
    char name[32];
    std::snprintf(name, sizeof name, "scan-%04d", number);
    const Result<std::optional<memory::Scan>> known = operator_control_->memory().scan(name);
    if (!fs::exists(options_.out / name, error) && !(known && *known)) return options_.out / name;
  }
}

void Service::look_for_next_folder() {
  next_folder_ = std::async(std::launch::async, [this] { return next_folder(); });
}

fs::path Service::take_next_folder() {
  if (next_folder_.valid()) {
    const fs::path folder = next_folder_.get();
    std::error_code error;
    // Somebody may have put one there by hand meanwhile.
    if (!fs::exists(folder, error)) return folder;
  }
  return next_folder();
}

bool Service::sensor_hears() const {
  const Sensing sensing = operator_control_->cell().sensing();
  return link_ && sensing != Sensing::Starting && sensing != Sensing::Away;
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
