// SPDX-License-Identifier: MIT
// In each state of the cell: what is offered is taken, and what is not offered is refused.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <map>
#include <set>
#include <thread>
#include <vector>

#include "host/apps/biteline-host/operator_control.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/apps/opened_operator_control.hpp"

namespace biteline::service {
namespace {

constexpr const char* k_offered = "scan-0001";
const std::set<std::string> k_commands{"start", "rescan",  "accept", "reject", "hold",
                                       "model", "process", "air",    "look",   "mend"};

/// Each command meets a cell of its own, as each changes it.
struct OneCell {
  test::TemporaryFolder folder;
  robot::Stops stops;
  std::unique_ptr<OperatorControl> sut;
};
using State = std::function<void(OperatorControl&)>;

std::unique_ptr<OneCell> open(bool with_arm, bool on_demand) {
  auto cell = std::make_unique<OneCell>();
  OperatorControlConfig config;
  config.results = cell->folder.path();
  config.arm = with_arm ? "UR5e" : "";
  config.stops = &cell->stops;
  if (on_demand) config.jobs = {line_control::Job{.number = 1}};
  if (with_arm) {
    config.rerun_arm =
        RerunArm{.model = *kinematics::arm_model("UR5e"),
                 .process = *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / "rough.yaml"),
                 .table_z_mm = 0};
  }
  auto opened = OperatorControl::open(config);
  SUCCEEDS(opened);
  cell->sut = std::move(*opened);
  return cell;
}

Result<void> say(const OneCell& cell, const std::string& command) {
  using Kind = api::Decision::Kind;
  OperatorControl& sut = *cell.sut;
  // Said now, and not before a stop.
  const std::uint64_t stops = cell.stops.count();
  const api::Speaker ada{"ada", stops};
  const auto decide = [&](Kind kind) {
    return sut.decide(
        {.kind = kind, .scan = k_offered, .who = "ada", .why = "so", .door = "web", .stops = stops});
  };
  if (command == "start") return sut.start({}, ada);
  if (command == "rescan")
    return sut.rescan({.who = "ada", .why = "so", .door = "web", .hold = false, .stops = stops});
  if (command == "accept") return decide(Kind::Accept);
  if (command == "reject") return decide(Kind::Reject);
  if (command == "hold") return decide(Kind::Hold);
  if (command == "model") return sut.choose_model(k_offered, "boot", ada);
  if (command == "process") return sut.choose_process(k_offered, "rough", ada);
  if (command == "air") return sut.run_in_air(k_offered, ada);
  if (command == "look") return sut.look_again(k_offered, ada);
  return sut.begin_mend(k_offered);
}

void put_row(OperatorControl& sut, const char* decision) {
  memory::Scan row;
  row.name = k_offered;
  row.time = 1;
  row.verdict = "ok";
  row.decision = decision;
  SUCCEEDS(sut.memory().put_scan(row, memory::LogRow{}));
}
State held(Waits waits, double fresh_s) {
  return [=](OperatorControl& sut) {
    put_row(sut, "held");
    test::work(sut, k_offered);
    sut.hold({.scan = k_offered, .waits = waits, .fresh_s = fresh_s});
  };
}

struct Situation {
  const char* name;
  std::function<void(OperatorControl&)> state;
  bool with_arm{true};
  bool on_demand{false};
  /// Not offered, and taken all the same where somebody insists.
  std::set<std::string> may{};
};

/// All that a person can meet.
std::vector<Situation> situations() {
  // What was never said to wait can be held again, and changes nothing.
  const std::set<std::string> hold{"hold"};
  // A run in the air of one that is too old is refused by the gate alone.
  const std::set<std::string> of_gate{"hold", "air"};
  std::vector<Situation> all{
      {"fresh", held(Waits::ForWord, 100), true, false, hold},
      {"without an arm", held(Waits::ForWord, 100), false, false, hold},
      {"model", held(Waits::ForModel, 100), true, false, hold},
      {"no path", held(Waits::ForPath, 100), true, false, hold},
      {"too old", held(Waits::ForWord, -1), true, false, of_gate},
      {"not sendable",
       [](OperatorControl& sut) {
         put_row(sut, "held");
         test::hold_worked(sut,
                           {.scan = k_offered,
                            .waits = Waits::ForWord,
                            .fresh_s = 100,
                            .not_sendable = report::ToldRefusal{
                                .reason_code = "messages_lost", .reason = "lost", .next_step = "again"}});
       },
       true, false, of_gate},
      {"mended",
       [](OperatorControl& sut) {
         held(Waits::ForWord, 100)(sut);
         SUCCEEDS(sut.begin_mend(k_offered));
       },
       true, false, hold},
      {"planned anew",
       [](OperatorControl& sut) {
         held(Waits::ForWord, 100)(sut);
         SUCCEEDS(sut.choose_process(k_offered, "rough", "ada"));
       }},
      {"looked at again",
       [](OperatorControl& sut) {
         held(Waits::ForWord, 100)(sut);
         sut.enter(CellEvent::Heard);
         SUCCEEDS(sut.look_again(k_offered, "ada"));
       }},
      {"run in the air",
       [](OperatorControl& sut) {
         held(Waits::ForWord, 100)(sut);
         SUCCEEDS(sut.run_in_air(k_offered, "ada"));
         sut.enter(CellEvent::AirSetsOut);
       }},
      {"accepted", [](OperatorControl& sut) {
         held(Waits::ForWord, 100)(sut);
         SUCCEEDS(sut.decide({.kind = api::Decision::Kind::Accept,
                              .scan = k_offered,
                              .who = "bob",
                              .why = {},
                              .door = "web"}));
       }}};
  for (const bool on_demand : {false, true}) {
    // Of a scan that nobody knows a mend finds no line: the API looks before the cell does.
    all.push_back(
        {"waits", [](OperatorControl& sut) { sut.enter(CellEvent::Heard); }, true, on_demand, {"mend"}});
    all.push_back({"scans", [](OperatorControl& sut) { sut.scan_begins(k_offered); }, true, on_demand});
    all.push_back({"works it out, too late to hold",
                   [](OperatorControl& sut) {
                     test::work(sut, k_offered);
                     CHECK_FALSE(sut.wants_hold_at_last(k_offered));
                   },
                   true, on_demand});
    all.push_back({"follows",
                   [](OperatorControl& sut) {
                     test::work(sut, k_offered);
                     sut.enter(CellEvent::ArmSetsOut);
                   },
                   true, on_demand});
    all.push_back({"stopped",
                   [](OperatorControl& sut) {
                     held(Waits::ForWord, 100)(sut);
                     sut.stop("ada");
                   },
                   true,
                   on_demand,
                   {"mend", "reject"}});
  }
  return all;
}

}  // namespace

TEST_GROUP(OperatorControlOffers){};

TEST(OperatorControlOffers, WhatIsOfferedIsTakenAndWhatIsNotIsRefused) {
  for (const Situation& situation : situations()) {
    for (const std::string& command : k_commands) {
      const std::unique_ptr<OneCell> cell = open(situation.with_arm, situation.on_demand);
      situation.state(*cell->sut);
      const api::Json offers = cell->sut->state()["offers"];
      const bool offered = std::ranges::find(offers, api::Json(command)) != offers.end();
      const Result<void> said = say(*cell, command);
      const std::string what =
          std::string{situation.name} + ": " + command + " " + (said ? "" : to_line(said.error()));
      if (offered || !situation.may.contains(command))
        CHECK_EQUAL_TEXT(offered, said.has_value(), what.c_str());
      if (said) continue;
      // 409, or 404 of a scan that has no row yet.
      const Errc code = said.error().code;
      CHECK_TEXT(code == Errc::WrongState || code == Errc::FileNotFound, what.c_str());
    }
  }
}

/// Two people press at once: one word about what is held is taken, and nothing moves without one.
TEST(OperatorControlOffers, OfTwoWordsAtOnceAboutWhatIsHeldOneCounts) {
  const std::set<std::string> words{"accept", "reject", "model", "process", "air", "look"};
  for (const Situation& situation : situations()) {
    for (const std::string& command : k_commands) {
      const std::unique_ptr<OneCell> cell = open(situation.with_arm, situation.on_demand);
      situation.state(*cell->sut);
      while (cell->sut->next_command()) {
      }
      const bool moved = cell->sut->cell().arm_will_move();
      std::atomic<int> taken{0};
      std::array<std::thread, 2> people;
      for (std::thread& person : people) person = std::thread{[&] { taken += say(*cell, command) ? 1 : 0; }};
      for (std::thread& person : people) person.join();
      const std::string what = std::string{situation.name} + ": " + command;
      if (words.contains(command)) CHECK_TEXT(taken <= 1, what.c_str());
      int of_held = 0;
      while (const std::optional<OperatorCommand> command = cell->sut->next_command())
        of_held += command->of_held() ? 1 : 0;
      CHECK_TEXT(of_held <= 1, what.c_str());
      if (!moved && command != "accept") CHECK_FALSE_TEXT(cell->sut->cell().arm_will_move(), what.c_str());
    }
  }
}

}  // namespace biteline::service
