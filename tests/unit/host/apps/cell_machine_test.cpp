// SPDX-License-Identifier: MIT
// Every event in every state that the cell can come to.
#include "host/apps/biteline-host/cell_machine.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <set>
#include <tuple>
#include <vector>

namespace biteline::service {
namespace {

using enum CellEvent;
constexpr std::array k_events{Heard,      Lost,       Asks,  Refuses, ScanBegins, ScanIsIn,  Works,
                              ArmSetsOut, AirSetsOut, Holds, Done,    Inspects,   Accept,    Plan,
                              Look,       Reject,     Start, Stop,    Spent,      AsksPerson};
constexpr std::size_t k_last_event = static_cast<std::size_t>(AsksPerson);
static_assert(k_events.size() == k_last_event + 1, "each event once");
/// Of a person, about what is held.
constexpr std::array k_words{Accept, Plan, Look, Reject};

auto key(const CellMachine& cell) {
  return std::tuple{cell.sensing(), cell.shoe(), cell.going()};
}

bool is_word(CellEvent event) {
  return std::ranges::find(k_words, event) != k_words.end();
}

struct Step {
  CellMachine from;
  CellEvent event;
  CellMachine to;
  bool taken;
};

CellMachine after(std::initializer_list<CellEvent> events) {
  CellMachine cell;
  for (const CellEvent event : events) CHECK_TEXT(cell.on(event), "a row of the table is missing");
  return cell;
}

}  // namespace

TEST_GROUP(CellMachine){/// All of them, from the beginning on.
                        static std::vector<Step> all_steps(){std::vector<Step> steps;
std::set<decltype(key(CellMachine{}))> seen{key(CellMachine{})};
std::deque<CellMachine> open{CellMachine{}};
while (!open.empty()) {
  const CellMachine from = open.front();
  open.pop_front();
  for (const CellEvent event : k_events) {
    CellMachine to = from;
    const bool taken = to.on(event);
    steps.push_back({from, event, to, taken});
    if (seen.insert(key(to)).second) open.push_back(to);
  }
}
return steps;
}  // namespace biteline::service
static void for_all(const std::function<bool(const Step&)>& holds) {
  const std::vector<Step> steps = all_steps();
  CHECK_COMPARE(steps.size(), >, 1000);
  for (const Step& step : steps) CHECK(holds(step));
}
}
;

TEST(CellMachine, WhatIsNotTakenChangesNothing) {
  for_all([](const Step& step) {
    return step.taken == step.from.takes(step.event) && (step.taken || key(step.from) == key(step.to));
  });
}

TEST(CellMachine, AStopIsTakenAlwaysAndOnlyAStartTakesItBack) {
  for_all([](const Step& step) {
    if (step.event == Stop) return step.taken && step.to.going() == Going::Stopped;
    return step.from.going() != Going::Stopped || step.to.going() == Going::Stopped || step.event == Start;
  });
}

TEST(CellMachine, NothingWaitsPastAStop) {
  for_all([](const Step& step) { return step.event != Stop || step.to.shoe() != Shoe::Held; });
}

TEST(CellMachine, AnArmSetsOutByTheServicesWorkAlone) {
  for_all([](const Step& step) {
    if (step.from.arm_moves() || !step.to.arm_moves()) return true;
    const Shoe from = step.from.shoe();
    if (step.event == AirSetsOut) return from == Shoe::Planning;
    return step.event == ArmSetsOut &&
           (from == Shoe::Working || from == Shoe::Planning || from == Shoe::Accepted);
  });
}

TEST(CellMachine, AWordIsTakenOnceAndOfWhatIsHeldAlone) {
  for_all([](const Step& step) {
    if (!is_word(step.event)) return true;
    return step.taken == (step.from.shoe() == Shoe::Held) && step.to.shoe() != Shoe::Held;
  });
}

TEST(CellMachine, NoLightIsAskedForBesideAShoeInWork) {
  for_all([](const Step& step) {
    const CellMachine& cell = step.from;
    if (!cell.may_ask()) return true;
    // A look is a person's word about what is held; all else wants a cell that goes.
    const bool next_scan = cell.shoe() == Shoe::None && cell.going() == Going::Goes;
    // What was worked is looked at until somebody says stop.
    const bool after_work = cell.shoe() == Shoe::Inspecting && cell.going() != Going::Stopped;
    return cell.sensing() == Sensing::Idle && (next_scan || after_work || cell.shoe() == Shoe::Looking);
  });
}

TEST(CellMachine, OnlyWhatTheArmHasFollowedIsLookedAtAfterTheWork) {
  for_all([](const Step& step) {
    if (step.from.shoe() == Shoe::Inspecting || step.to.shoe() != Shoe::Inspecting) return true;
    return step.event == Inspects && step.from.shoe() == Shoe::Following;
  });
}

/// No next shoe, and no arm, before the look has been worked out.
TEST(CellMachine, AShoeThatIsLookedAtAfterTheWorkIsLeftByTheServicesWorkAlone) {
  for_all([](const Step& step) {
    if (step.from.shoe() != Shoe::Inspecting || step.to.shoe() == Shoe::Inspecting) return true;
    return step.event == Works || step.event == Done;
  });
}

TEST(CellMachine, WherePeopleMustLookNoScanIsAskedForBeforeAStart) {
  for_all([](const Step& step) {
    if (step.event != AsksPerson) return true;
    return step.taken && step.to.going() != Going::Goes && step.to.shoe() == step.from.shoe();
  });
  CellMachine cell = after({Heard, Works, ArmSetsOut, Inspects});
  CHECK(cell.may_ask());
  CHECK(cell.state(Hindrance::None) == CellState::Scanning);
  for (const CellEvent event : {Works, AsksPerson, Done}) CHECK(cell.on(event));
  CHECK(!cell.may_ask());
  CHECK(cell.on(Start));
  CHECK(cell.may_ask());
}

TEST(CellMachine, ASensorThatIsLostLosesNoScanAndNoShoe) {
  for_all([](const Step& step) {
    if (step.event != Lost) return true;
    const bool scan_stays =
        step.from.sensing() != Sensing::Scanning || step.to.sensing() == Sensing::Scanning;
    return scan_stays && step.from.shoe() == step.to.shoe() && step.from.going() == step.to.going();
  });
}

TEST(CellMachine, WhatTheSensorSaysTouchesNoShoe) {
  constexpr std::array k_sensor{Heard, Lost, Asks, Refuses, ScanBegins, ScanIsIn};
  for_all([&](const Step& step) {
    if (std::ranges::find(k_sensor, step.event) == k_sensor.end()) return true;
    return step.from.shoe() == step.to.shoe() && step.from.going() == step.to.going();
  });
}

TEST(CellMachine, FromEveryStateThereIsAWayToTheNextScan) {
  for (const Step& step : all_steps()) {
    CellMachine cell = step.to;
    for (const CellEvent event : {ScanIsIn, Lost, Heard, Stop, Works, Done, Start})
      static_cast<void>(cell.on(event));
    CHECK(cell.may_ask());
  }
}

TEST(CellMachine, TellsOneState) {
  using enum Hindrance;
  CHECK(CellMachine{}.state(None) == CellState::Starting);
  CHECK(after({Lost}).state(None) == CellState::NoSensor);
  CHECK(after({Heard}).state(None) == CellState::Idle);
  CHECK(after({Heard}).state(Robot) == CellState::NotReady);
  CHECK(after({Heard}).state(Rest) == CellState::Resting);
  CHECK(after({Heard, Spent}).state(None) == CellState::WaitsForStart);
  CHECK(after({Heard, Asks}).state(None) == CellState::Idle);
  CHECK(after({Heard, Asks, ScanBegins}).state(None) == CellState::Scanning);
  // The shoe before is told while the sensor brings the next one.
  CHECK(after({ScanBegins, ScanIsIn, Works, ScanBegins}).state(None) == CellState::Working);
  CHECK(after({Works, Holds}).state(Rest) == CellState::Held);
  CHECK(after({Works, Holds, Plan}).state(None) == CellState::Working);
  CHECK(after({Works, Holds, Look}).state(None) == CellState::Scanning);
  CHECK(after({Works, Holds, Accept}).state(None) == CellState::Following);
  CHECK(after({Works, Holds, Accept, Stop}).state(None) == CellState::Stopped);
  CHECK(after({Works, Holds, Plan, AirSetsOut}).state(None) == CellState::Following);
  // An arm that comes to rest after a stop is told as that.
  CHECK(after({Works, ArmSetsOut, Stop}).state(None) == CellState::Following);
  CHECK(after({Works, ArmSetsOut, Stop, Done}).state(None) == CellState::Stopped);
}

}  // namespace biteline::service
