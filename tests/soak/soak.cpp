// SPDX-License-Identifier: MIT
#include "tests/soak/soak.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "hal/sim/live/urgency.hpp"

namespace biteline::soak {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using sim::Line;

/// The sensor's promise (tests/integration/faults/README.md).
constexpr double k_dark_within_ms = 100;
/// The host's: stop on the wire within 0.1 s, the arm known at rest 0.3 s after it (ROBOT.md).
constexpr double k_rest_within_ms = 400;
/// What the guard of the laser leaves for the machine (tests/support/timed_test.hpp).
constexpr double k_machine_late_ms = 25;
/// The service has ordinary rights.  Of one second: a tenth of the sensor's patience with a silent service.
constexpr double k_programs_late_ms = 200;
/// Longer than any step of the service on a busy machine.
constexpr auto k_silence = 180s;
/// A service that left: two seconds without a word, five of patience, and a bit.
constexpr auto k_dark_without_host = 10s;
/// A service asks for the next scan at once: a thread that still hangs spoils that one, too.
constexpr auto k_aftermath = 1s;
/// Rounds have a sound scan for so many faults.
constexpr std::size_t k_faults_for_a_sound_one = 3;

std::chrono::milliseconds between(std::mt19937_64& random, std::chrono::milliseconds least,
                                  std::chrono::milliseconds most) {
  return std::chrono::milliseconds{
      std::uniform_int_distribution<std::int64_t>{least.count(), most.count()}(random)};
}

}  // namespace

Soak::Soak(Stand& stand, const SoakSettings& settings)
    : stand_{stand}, settings_{settings}, random_{settings.seed} {}

void Soak::find(const std::string& what) {
  wrong_.push_back((running_ ? running_->name + " (" + running_->fault->name + "): " : "") + what);
  std::printf("WRONG %s\n", wrong_.back().c_str());
  std::fflush(stdout);
}

double Soak::own_ms(const Wakeups& machine, Clock::time_point from, Clock::time_point until) {
  const double whole_ms = std::chrono::duration<double, std::milli>(until - from).count();
  return std::max(0.0, whole_ms - machine.stalled_ms(from, until));
}

void Soak::probe_anew() {
  urgent_ = std::make_unique<Wakeups>(Wakeups::Rank::Urgent);
  ordinary_ = std::make_unique<Wakeups>(Wakeups::Rank::Ordinary);
}

const Fault& Soak::next_fault() {
  const std::span<const Fault> table = fault_table();
  if (bag_.empty()) {
    bag_.resize(table.size() - 1);
    std::iota(bag_.begin(), bag_.end(), 1);
    bag_.resize(bag_.size() + bag_.size() / k_faults_for_a_sound_one, 0);
    std::shuffle(bag_.begin(), bag_.end(), random_);
  }
  const std::size_t number = bag_.back();
  bag_.pop_back();
  return table[number];
}

void Soak::run() {
  const Clock::time_point until =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double, std::ratio<60>>{settings_.minutes});
  probe_anew();
  heard_ = Clock::now();
  for (;;) {
    // The service says what it asks for before it asks: what has shone by now was said by then.
    const std::uint64_t lit = stand_.cell().lightings();
    if (!hear_all(until)) break;
    balance_light(lit);
    for (std::string& script : stand_.between().take_scripts()) {
      if (script.find("def biteline_path") != std::string::npos) scripts_.push_back(std::move(script));
    }
    work_fault();
    watch_light(Clock::now());
    keep_programs();
    if (Clock::now() - heard_ > k_silence) {
      find("the service has said nothing for three minutes: " + stand_.host().last_words());
      return;
    }
  }
  settle();
  end();
}

bool Soak::hear_all(Clock::time_point until) {
  for (std::chrono::milliseconds patience{5};; patience = 0ms) {
    const std::optional<HostWord> word = stand_.hear_host(patience);
    if (!word) return true;
    heard_ = Clock::now();
    const bool next = word->kind == HostWord::Kind::TakesIn && running_ && word->scan != running_->name;
    if (next && Clock::now() > until) {
      begun_.insert(word->scan);
      return false;
    }
    hear(*word);
  }
}

void Soak::balance_light(std::uint64_t lit) {
  const std::uint64_t unasked = light_.unasked(lit, asked_);
  if (unasked == 0) return;
  find("the laser was lit " + std::to_string(unasked) + " times without being asked for: " +
       std::to_string(lit) + " lightings, " + std::to_string(asked_) + " askings");
}

void Soak::hear(const HostWord& word) {
  if (word.kind == HostWord::Kind::Asks) ++asked_;
  if (word.kind == HostWord::Kind::Sends && running_) running_->sent = Clock::now();
  if (word.kind != HostWord::Kind::TakesIn && word.kind != HostWord::Kind::Found) return;
  if (running_ && running_->name == word.scan) return;  // a new service goes on with it
  if (running_) settle();
  begin(word.scan);
}

/// Within the time that a scan, a way to the line and a line take.
std::chrono::milliseconds Soak::delay_of(Fault::When when) {
  if (when == Fault::When::OnLine) return between(random_, 100ms, 2s);
  return when == Fault::When::Follow ? between(random_, 500ms, 9s) : between(random_, 500ms, 6s);
}

void Soak::begin(const std::string& scan) {
  if (!begun_.insert(scan).second) find(scan + " is taken in a second time");
  const Fault& fault = next_fault();
  running_.emplace(Running{.name = scan, .fault = &fault, .delay = delay_of(fault.when)});
  running_->in_aftermath = Clock::now() < aftermath_until_;
  // A probe's memory is for one scan.
  probe_anew();
}

bool Soak::fault_due() {
  Running& run = *running_;
  const Clock::time_point now = Clock::now();
  const sim::LiveCell& cell = stand_.cell();
  const SensorClock::time_point instant = hal::monotonic_now();
  if (run.fault->when == Fault::When::Scan)
    return cell.level(Line::LaserEnable) && instant - cell.lit_since() >= run.delay;
  const sim::ArmState arm = cell.arm_at(instant);
  if (!run.sent || !arm.program_running) return false;
  if (run.fault->when == Fault::When::Follow) return now - *run.sent >= run.delay;
  if (arm.outputs == 0) return false;
  if (!run.on_line) run.on_line = now;
  return now - *run.on_line >= run.delay;
}

void Soak::work_fault() {
  if (!running_ || running_->fault->when == Fault::When::Never) return;
  Running& run = *running_;
  if (!run.made) {
    if (!fault_due()) return;
    const sim::ArmState arm = stand_.cell().arm_at(hal::monotonic_now());
    run.made_at_mm = (arm.T_base_flange * arm.T_flange_tcp).translation();
    {
      // Nobody comes between the stamp and what it stamps: as an ordinary thread this one may wait long
      // there.
      const sim::Urgently urgently{sim::k_wires_priority};
      run.made = Clock::now();
      run.undo = run.fault->make(stand_);
    }
    aftermath_until_ = *run.made + run.fault->lasts + k_aftermath;
    return;
  }
  const Clock::time_point now = Clock::now();
  watch_dark(now);
  watch_rest(now);
  if (!run.repaired && now - *run.made >= run.fault->lasts) {
    run.undo.reset();
    run.repaired = true;
  }
}

void Soak::watch_dark(Clock::time_point now) {
  Running& run = *running_;
  if (!run.fault->darkens || run.dark) return;
  const bool dark = !stand_.cell().enabled(hal::monotonic_now());
  if (!dark && now - *run.made < 2s) return;
  // The cell's own stamp: this thread may have been late to look, and the kernel to let go of a dead
  // program's line.
  const Clock::time_point fell{
      std::chrono::duration_cast<Clock::duration>(stand_.cell().disabled_since().time_since_epoch())};
  run.dark = dark ? std::max(fell, *run.made) : now;
  const double dark_ms = own_ms(*urgent_, *run.made, *run.dark);
  Row& row = rows_[run.fault->name];
  row.worst_ms = std::max(row.worst_ms, dark_ms);
  if (dark && dark_ms <= k_dark_within_ms) return;
  char text[120];
  std::snprintf(text, sizeof text, "the laser shone on for %.0f ms", dark_ms);
  find(text);
}

void Soak::watch_rest(Clock::time_point now) {
  Running& run = *running_;
  if (run.fault->outcomes != any_of({Outcome::Halted}) || run.rest) return;
  const sim::ArmState arm = stand_.cell().arm_at(hal::monotonic_now());
  if (arm.program_running && now - *run.made < 10s) return;
  run.rest = now;
  run.rest_at_mm = (arm.T_base_flange * arm.T_flange_tcp).translation();
  const double rest_ms = own_ms(*ordinary_, *run.made, now);
  Row& row = rows_[run.fault->name];
  row.worst_ms = std::max(row.worst_ms, rest_ms);
  row.worst_gone_mm = std::max(row.worst_gone_mm, (run.rest_at_mm - run.made_at_mm).norm());
  if (rest_ms <= k_rest_within_ms + static_cast<double>(run.fault->noticed.count())) return;
  char text[120];
  std::snprintf(text, sizeof text, "the arm went on for %.0f ms", rest_ms);
  find(text);
}

void Soak::watch_light(Clock::time_point now) {
  sim::LiveCell& cell = stand_.cell();
  const bool path_runs = cell.arm_at(hal::monotonic_now()).program_running;
  const bool closed = cell.level(Line::Interlock) && cell.level(Line::Key) && !cell.level(Line::TooHot);
  const bool may_shine = closed && !path_runs;
  if (may_shine) {
    must_be_dark_since_.reset();
    violated_ = false;
    return;
  }
  if (!must_be_dark_since_) must_be_dark_since_ = now;
  const bool late = own_ms(*urgent_, *must_be_dark_since_, now) > k_dark_within_ms;
  if (!late || !cell.level(Line::LaserEnable) || violated_) return;
  violated_ = true;
  find(path_runs ? "the laser shines while the arm follows a path" : "the laser shines behind an open door");
}

void Soak::keep_programs() {
  if (stand_.sensor().running() && stand_.host().running() && stand_.page().program().running()) {
    ended_.reset();
    return;
  }
  const Clock::time_point now = Clock::now();
  if (!ended_) ended_ = now;
  if (now - *ended_ < 300ms) return;  // as systemd would
  const bool meant = running_ && running_->made && running_->fault->lasts == 0ms;
  if (!meant) {
    find("a program ended by itself: sensor: " + stand_.sensor().last_words() +
         "; host: " + stand_.host().last_words() + "; page: " + stand_.page().program().last_words());
  }
  if (const Result<int> revived = stand_.revive(); !revived) find(to_line(revived.error()));
}

void Soak::settle() {
  Running& run = *running_;
  const bool made = run.made.has_value();
  run.undo.reset();
  const fs::path folder = stand_.results() / run.name;
  const ScanAccount account = read_account(folder);
  const std::size_t wrong_before = wrong_.size();
  settle_scripts(account);
  // A fault whose turn did not come, since the scan was over before, leaves a sound scan.
  const Fault& fault = made ? *run.fault : fault_table().front();
  Row& row = rows_[fault.name];
  ++row.scans;
  ++row.outcomes[static_cast<std::size_t>(account.outcome)];
  const double late_ms = urgent_->worst_ms(), programs_late_ms = ordinary_->worst_ms(1s);
  const bool right_kind = contains(fault.outcomes, account.outcome);
  const bool has_reason = account.outcome == Outcome::Refused || account.outcome == Outcome::Halted;
  const bool right_reason = !has_reason || account.reason.find(fault.reason) != std::string::npos;
  const bool late = late_ms > k_machine_late_ms || programs_late_ms > k_programs_late_ms;
  const bool excused = late && account.outcome != Outcome::Open && account.outcome != Outcome::Abandoned;
  if (account.profiles == 0) ++dark_scans_;
  if (!(right_kind && right_reason) && run.in_aftermath && account.outcome == Outcome::Refused) {
    ++row.aftermaths;
  } else if (!(right_kind && right_reason) && excused) {
    ++row.excused;
  } else if (!right_kind || !right_reason) {
    find(std::string{name_of(account.outcome)} + " " + account.reason);
  }
  memory_.note("sensor", stand_.sensor().pid(), resident_mb(stand_.sensor().pid()));
  memory_.note("host", stand_.host().pid(), resident_mb(stand_.host().pid()));
  memory_.note("page", stand_.page().program().pid(), resident_mb(stand_.page().program().pid()));
  memory_.note("cell", ::getpid(), resident_mb(::getpid()));
  std::printf(
      "%s  %-26s %-9s %s%s (machine late by up to %.0f ms, ordinary programs by %.0f ms of a second; lit "
      "%llu times, asked for %llu times, %zu scans)\n",
      run.name.c_str(), run.fault->name, name_of(account.outcome), account.reason.c_str(),
      made || !run.fault->make ? "" : " not made", late_ms, programs_late_ms,
      static_cast<unsigned long long>(stand_.cell().lightings()), static_cast<unsigned long long>(asked_),
      begun_.size());
  std::fflush(stdout);
  // What came out even is not kept: an hour of clouds is large.
  if (wrong_.size() == wrong_before) {
    std::error_code error;
    fs::remove_all(folder, error);
  }
  running_.reset();
}

void Soak::settle_scripts(const ScanAccount& account) {
  const bool sent = account.outcome == Outcome::Followed || account.outcome == Outcome::Halted ||
                    account.outcome == Outcome::Abandoned;
  if (!scripts_.empty() && !account.permitted) find("a path was sent that the gate did not permit");
  if (account.outcome == Outcome::Followed && !account.own_arm)
    find("a path was planned for the nominal arm");
  if (sent && scripts_.empty()) find("a path is said to be followed that nobody sent");
  if (scripts_.size() > 1) find("a path was sent twice");
  for (const std::string& script : scripts_) {
    // The way to the path's beginning stands before the path's own moves, the end of the dead man behind
    // them.
    const std::size_t last = account.script.rfind("movep"), end = account.script.rfind("end\n");
    if (last == std::string::npos || end == std::string::npos || end < last ||
        script.find(account.script.substr(last, end - last)) == std::string::npos)
      find("a path was sent that is not this scan's");
  }
  scripts_.clear();
}

void Soak::end() {
  stand_.host().stop();
  const Clock::time_point left = Clock::now();
  while (stand_.cell().level(Line::LaserEnable) && Clock::now() - left < k_dark_without_host)
    std::this_thread::sleep_for(20ms);
  if (stand_.cell().level(Line::LaserEnable)) find("the laser shines for a service that is gone");
  // While the last books were balanced it went on with scans that nobody watched.
  const std::size_t watched = begun_.size();
  for (const HostWord& word : stand_.last_host_words()) {
    if (word.kind == HostWord::Kind::Asks) ++asked_;
    if (word.kind == HostWord::Kind::TakesIn) begun_.insert(word.scan);
  }
  const std::uint64_t lit = stand_.cell().lightings();
  balance_light(lit);
  if (asked_ < begun_.size()) {
    find(std::to_string(begun_.size()) + " scans for " + std::to_string(asked_) + " askings");
  }
  // The newest scan that was watched was just asked for.
  if (lit + dark_scans_ + 1 < watched) {
    find("the laser was lit " + std::to_string(lit) + " times for " + std::to_string(watched) + " scans");
  }
  for (const std::string& growth : memory_.growths()) find(growth);
  const Seen seen = stand_.page().seen();
  if (seen.pictures == 0 || seen.profiles == 0 || seen.answers == 0) find("the page showed nothing");
}

void Soak::print_tables() const {
  std::printf("\n%-28s %5s", "fault", "scans");
  for (std::size_t i = 0; i < k_outcomes; ++i) std::printf(" %9s", name_of(static_cast<Outcome>(i)));
  std::printf("  aftermath  late machine  dark or at rest, ms  gone, mm\n");
  int scans = 0, accounts[k_outcomes]{};
  for (const auto& [name, row] : rows_) {
    std::printf("%-28s %5d", name.c_str(), row.scans);
    for (std::size_t i = 0; i < k_outcomes; ++i) {
      std::printf(" %9d", row.outcomes[i]);
      accounts[i] += row.outcomes[i];
    }
    std::printf("  %9d  %12d  %19.0f  %8.1f\n", row.aftermaths, row.excused, row.worst_ms, row.worst_gone_mm);
    scans += row.scans;
  }
  std::printf("%-28s %5d", "all", scans);
  for (const int number : accounts) std::printf(" %9d", number);
  std::printf("\n\n%s\n", memory_.table().c_str());
  const Seen seen = stand_.page().seen();
  std::printf("page: %llu pictures, %llu profiles, %llu states\n",
              static_cast<unsigned long long>(seen.pictures), static_cast<unsigned long long>(seen.profiles),
              static_cast<unsigned long long>(seen.answers));
  for (const auto& [why, times] : seen.losses)
    std::printf("page: connected anew %d times: %s\n", times, why.c_str());
}

}  // namespace biteline::soak
