// SPDX-License-Identifier: MIT
// A look at what is held: an ordinary scan that shows whether the shoe still stands as it was scanned.
#include <pthread.h>

#include <utility>

#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/cloud/ply.hpp"
#include "host/report/report.hpp"
#include "host/transfer/moved.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_look_folder = "look";

const char* name_of(transfer::Moved::Verdict verdict) {
  switch (verdict) {
    case transfer::Moved::Verdict::Unmoved:
      return "unmoved";
    case transfer::Moved::Verdict::Moved:
      return "moved";
    case transfer::Moved::Verdict::OtherShoe:
      return "other_shoe";
    case transfer::Moved::Verdict::NotSeen:
      return "not_seen";
  }
  return "not_seen";
}

Result<void> write_look(const fs::path& folder, const transfer::Moved& moved) {
  report::Report report;
  report.fields["moved"] = {
      {"verdict", name_of(moved.verdict)},      {"shift_mm", moved.shift_mm}, {"u95_mm", moved.u95_mm},
      {"unexplained_mm", moved.unexplained_mm}, {"limit_mm", moved.limit_mm}, {"words", moved.words}};
  return report.write(folder);
}

}  // namespace

bool Service::looks() const {
  return held_ && !result_.valid() && operator_control_->cell().shoe() == Shoe::Looking;
}

Result<void> Service::begin_look(const intake::Hello& hello) {
  const fs::path folder = held_->scan.folder / k_look_folder;
  std::error_code error;
  fs::remove_all(folder, error);
  BITELINE_TRY(report::prepare_folder(folder));
  BITELINE_ASSIGN(intake::ScanIntake intake, intake::ScanIntake::begin(folder, hello, link_->packet()));
  scan_.emplace(Scan{.folder = folder, .intake = std::move(intake), .line = {}, .connection = connection()});
  scan_->look = true;
  scan_->mark = held_->scan.mark;
  asked_.reset();
  operator_control_->enter(CellEvent::ScanBegins);
  show_scan(*scan_);
  log_step("looks again at %s", held_->name().c_str());
  return {};
}

void Service::give_up_look(const std::string& why) {
  log_step("%s is not looked at: %s", held_->name().c_str(), why.c_str());
  held_->look_words = "not looked at: " + why;
  tell_aside(false);
}

void Service::tell_aside(bool again) {
  result_ = std::async(std::launch::async, [this, again, held = std::move(*held_)]() mutable -> Worked {
    pthread_setname_np(pthread_self(), "bl-result");
    if (Planned* const planned = held.planned()) {
      // What cannot be read is told by whoever sends it.
      if (const auto now = mounted(planned->plan.request.process)) planned->request.mounted = *now;
    }
    tell_held(held, again);
    return {.status = ExitStatus::Done, .held = std::move(held)};
  });
  held_.reset();
}

Service::Worked Service::look_at_held(HeldScan held, Scan look) {
  operator_control_->show("compares " + held.name() + " with what stands there now", "a person decides");
  held.look_words.clear();
  const Result<ExitStatus> done = without_exceptions([&]() -> Result<ExitStatus> {
    const intake::ScanOutcome outcome = look.intake.finish();
    look.intake.forget();
    BITELINE_ASSIGN(const cloud::PointCloud scanned, cloud::read_cloud(held.scan.folder / "cloud.ply"));
    Planned& planned = *held.planned();
    std::vector<Vec3> line;
    for (const cloud::LinePoint& point : planned.plan.request.line.points) line.push_back(point.position);
    const transfer::Moved moved = transfer::moved_since(scanned, outcome.cloud, line);
    held.look_words = moved.words;
    log_step("%s: %s", held.name().c_str(), moved.words.c_str());
    // First: what was seen counts also where it cannot be written down.  A look that was cut off may tell
    // that the shoe was moved, and never that it was not.
    const bool counts = moved.verdict != transfer::Moved::Verdict::NotSeen &&
                        (look.ended || moved.verdict != transfer::Moved::Verdict::Unmoved);
    if (counts) planned.request.looked = Looked{.at = look.ended.value_or(now()), .shows = shown_by(moved)};
    BITELINE_TRY(write_look(look.folder, moved));
    return ExitStatus::Done;
  });
  if (!done && held.look_words.empty()) held.look_words = "not looked at: " + to_line(done.error());
  return hold_again(done, std::move(held));
}

void Service::look_at_clamp() {
  if (!clamp_) return;
  const bool holds = clamp_->held_since().has_value();
  if (holds == clamp_holds_ || result_.valid()) return;
  clamp_holds_ = holds;
  // How long it stays fresh, and whether a yes would be taken, is another answer now.
  if (held_ && operator_control_->cell().shoe() == Shoe::Held) tell_aside(true);
}

void Service::look_at_tool() {
  const int said = operator_control_->tools_mounted();
  if (said == tools_mounted_ || result_.valid()) return;
  tools_mounted_ = said;
  if (held_ && held_->planned() && operator_control_->cell().shoe() == Shoe::Held) tell_aside(true);
}

}  // namespace biteline::service
