// SPDX-License-Identifier: MIT
// In each state of the cell: what is offered is taken, and what is not offered is refused.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "host/apps/biteline-host/cockpit.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {
namespace {

constexpr const char* k_offered = "scan-0001";
const std::set<std::string> k_commands{"start", "rescan",  "accept", "reject", "hold",
                                       "model", "process", "air",    "mend"};
using Wait = Cockpit::Wait;

}  // namespace

TEST_GROUP(CockpitOffers) {
  /// Each command meets a cell of its own, as each changes it.
  struct OneCell {
    test::TemporaryFolder folder;
    robot::Stops stops;
    std::unique_ptr<Cockpit> sut;
  };
  using State = std::function<void(Cockpit&)>;

  static std::unique_ptr<OneCell> open(bool with_arm, bool on_demand) {
    auto cell = std::make_unique<OneCell>();
    CockpitConfig config;
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
    auto opened = Cockpit::open(config);
    SUCCEEDS(opened);
    cell->sut = std::move(*opened);
    return cell;
  }

  static Result<void> say(const OneCell& cell, const std::string& command) {
    using Kind = api::Decision::Kind;
    Cockpit& sut = *cell.sut;
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
    return sut.begin_mend(k_offered);
  }

  /// `may`: not offered, and taken all the same where somebody insists.
  static void offers_what_it_takes(const char* name, const State& state, bool with_arm = true,
                                   bool on_demand = false, const std::set<std::string>& may = {}) {
    for (const std::string& command : k_commands) {
      const std::unique_ptr<OneCell> cell = open(with_arm, on_demand);
      state(*cell->sut);
      const api::Json offers = cell->sut->state()["offers"];
      const bool offered = std::ranges::find(offers, api::Json(command)) != offers.end();
      const Result<void> said = say(*cell, command);
      const std::string what = std::string{name} + ": " + command + " " + (said ? "" : to_line(said.error()));
      if (offered || !may.contains(command)) CHECK_EQUAL_TEXT(offered, said.has_value(), what.c_str());
      if (said) continue;
      // 409, or 404 of a scan that has no row yet.
      const Errc code = said.error().code;
      CHECK_TEXT(code == Errc::WrongState || code == Errc::FileNotFound, what.c_str());
    }
  }

  static void put_row(Cockpit & sut, const char* decision) {
    memory::Scan row;
    row.name = k_offered;
    row.time = 1;
    row.verdict = "ok";
    row.decision = decision;
    SUCCEEDS(sut.memory().put_scan(row, memory::LogRow{}));
  }
  static State held(Wait wait, double fresh_s) {
    return [=](Cockpit& sut) {
      put_row(sut, "held");
      sut.show_scan(k_offered);
      sut.hold(k_offered, wait, fresh_s);
      sut.show(Phase::Deciding, "waits", "a word");
    };
  }
};

TEST(CockpitOffers, WhatAScanThatWaitsCanBeTold) {
  // A run in the air of one that is too old is refused by the gate alone.
  const std::set<std::string> of_gate{"air"};
  // What was never said to wait can be held again, and changes nothing.
  std::set<std::string> may{"hold"};
  offers_what_it_takes("fresh", held(Wait::Word, 100), true, false, may);
  offers_what_it_takes("without an arm", held(Wait::Word, 100), false, false, may);
  offers_what_it_takes("model", held(Wait::Model, 100), true, false, may);
  offers_what_it_takes("no path", held(Wait::Mend, 100), true, false, may);
  may.insert(of_gate.begin(), of_gate.end());
  offers_what_it_takes("too old", held(Wait::Word, -1), true, false, may);
  offers_what_it_takes(
      "not sendable",
      [](Cockpit& sut) {
        put_row(sut, "held");
        sut.hold(k_offered, Wait::Word, 100, {},
                 report::ToldRefusal{.reason_code = "messages_lost", .reason = "lost", .next_step = "again"});
      },
      true, false, may);
}

TEST(CockpitOffers, WhileItIsMendedOrWorkedOnNobodyDecides) {
  const std::set<std::string> may{"hold"};
  offers_what_it_takes(
      "mended",
      [](Cockpit& sut) {
        held(Wait::Word, 100)(sut);
        SUCCEEDS(sut.begin_mend(k_offered));
      },
      true, false, may);
  offers_what_it_takes("planned anew", [](Cockpit& sut) {
    held(Wait::Word, 100)(sut);
    SUCCEEDS(sut.choose_process(k_offered, "rough", "ada"));
  });
  offers_what_it_takes("run in the air", [](Cockpit& sut) {
    held(Wait::Word, 100)(sut);
    SUCCEEDS(sut.run_in_air(k_offered, "ada"));
    sut.show(Phase::Following, "the arm runs in the air", "a person decides");
  });
}

TEST(CockpitOffers, WhatACellTakesBetweenScansAndInThem) {
  const State waits = [](Cockpit& sut) { sut.show(Phase::Waiting, "waits", "the next scan"); };
  const State scans = [](Cockpit& sut) {
    sut.show_scan(k_offered);
    sut.show(Phase::Scanning, "comes in", "its line");
  };
  for (const bool on_demand : {false, true}) {
    // Of a scan that nobody knows a mend finds no line: the API looks before the cell does.
    offers_what_it_takes("waits", waits, true, on_demand, {"mend"});
    offers_what_it_takes("scans", scans, true, on_demand);
    offers_what_it_takes(
        "works it out, too late to hold",
        [&](Cockpit& sut) {
          scans(sut);
          sut.show(Phase::Working, "works", "its path");
          CHECK_FALSE(sut.wants_hold_at_last(k_offered));
        },
        true, on_demand);
    offers_what_it_takes(
        "follows",
        [&](Cockpit& sut) {
          scans(sut);
          sut.show(Phase::Following, "follows", "the next scan");
        },
        true, on_demand);
    offers_what_it_takes("stopped",
                         [&](Cockpit& sut) {
                           held(Wait::Word, 100)(sut);
                           sut.stop("ada");
                         },
                         true, on_demand, {"mend", "reject"});
  }
}

}  // namespace biteline::service
