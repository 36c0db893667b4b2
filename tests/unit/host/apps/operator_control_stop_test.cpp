// SPDX-License-Identifier: MIT
// A stop ends what was said before it, in whichever order the three come: said, stopped, carried out.
#include <CppUTest/TestHarness.h>

#include <functional>
#include <thread>

#include "host/apps/biteline-host/operator_control.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/apps/opened_operator_control.hpp"

namespace biteline::service {
namespace {

constexpr const char* k_scan = "scan-0001";

memory::Scan row_named(const std::string& decision) {
  memory::Scan row;
  row.name = k_scan;
  row.time = 1'000'000;
  row.verdict = "ok";
  row.decision = decision;
  return row;
}

}  // namespace

TEST_GROUP(OperatorControlStop) {
  test::TemporaryFolder folder;
  robot::Stops stops;
  std::unique_ptr<OperatorControl> sut;

  void open(const std::vector<line_control::Job>& jobs = {}, bool doors = false) {
    OperatorControlConfig config;
    if (doors) config.endpoint = *wire::parse_endpoint("tcp://127.0.0.1:0");
    config.results = folder.path();
    config.arm = "UR5e";
    config.rerun_arm =
        RerunArm{.model = *kinematics::arm_model("UR5e"),
                 .process = *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / "rough.yaml"),
                 .table_z_mm = 0};
    config.jobs = jobs;
    config.stops = &stops;
    auto opened = OperatorControl::open(config);
    SUCCEEDS(opened);
    sut = std::move(*opened);
    sut->hear(wire::SensorHello{});
  }
  void teardown() override {
    sut.reset();
  }
  void hold(Waits wait = Waits::ForWord) {
    SUCCEEDS(sut->memory().put_scan(row_named("held"), {}));
    test::work(*sut, k_scan);
    sut->show("scan-0001 waits for a person", "accept it");
    test::hold_worked(*sut, {.scan = k_scan, .waits = wait, .fresh_s = 100, .mark = sut->going()});
  }
  Result<void> decide(api::Decision::Kind kind, std::uint64_t heard) {
    return sut->decide(
        {.kind = kind, .scan = k_scan, .who = "ada", .why = "so", .door = "web", .stops = heard});
  }
  /// Wishes that the service would still handle, but for the stop's own.
  int alive() {
    int count = 0;
    while (const std::optional<OperatorCommand> command = sut->next_command()) {
      if (command->kind != OperatorCommand::Kind::Stop && command->kind != OperatorCommand::Kind::LaserOff &&
          !command->mark.stopped())
        ++count;
    }
    return count;
  }
  std::string state(const char* key) {
    return sut->state()[key].get<std::string>();
  }

  /// An order, and what must be so before it.
  struct Order {
    const char* name;
    bool starts;  ///< and so begins anew after a stop
    std::function<void()> prepare;
    std::function<bool(std::uint64_t heard)> say;
  };
  std::vector<Order> orders() {
    using enum api::Decision::Kind;
    const auto nothing = [] {};
    const auto held = [this] { hold(); };
    return {{"start", true, nothing,
             [this](auto heard) {
               return sut->start({}, {"ada", heard}).has_value();
             }},
            {"start that holds", true, nothing,
             [this](auto heard) {
               return sut->start({.model = {}, .process = {}, .hold = true}, {"ada", heard}).has_value();
             }},
            {"scan again", true, nothing,
             [this](auto heard) {
               return sut->rescan({.who = "ada", .why = "so", .door = "web", .stops = heard}).has_value();
             }},
            {"scan again what is held", true, held,
             [this](auto heard) {
               return sut->rescan({.who = "ada", .why = "so", .door = "web", .stops = heard}).has_value();
             }},
            {"accept", false, held, [this](auto heard) { return decide(Accept, heard).has_value(); }},
            {"send", false, held, [this](auto heard) { return decide(Send, heard).has_value(); }},
            {"run in the air", false, held,
             [this](auto heard) {
               return sut->run_in_air(k_scan, {"ada", heard}).has_value();
             }},
            {"another process", false, held,
             [this](auto heard) {
               return sut->choose_process(k_scan, "rough", {"ada", heard}).has_value();
             }},
            {"name the model", false, [this] { hold(Waits::ForModel); },
             [this](auto heard) {
               return sut->choose_model(k_scan, "boot", {"ada", heard}).has_value();
             }},
            {"a mended line", false,
             [this] {
               hold();
               SUCCEEDS(sut->begin_mend(k_scan));
             },
             [this](auto heard) {
               sut->end_mend(k_scan, true, {"ada", heard});
               return true;
             }}};
  }
  using Stop = void (OperatorControl::*)(const std::string&);
  static constexpr std::array<Stop, 2> k_stops{&OperatorControl::stop, &OperatorControl::laser_off};
};

TEST(OperatorControlStop, WithoutAStopEachOrderIsHeeded) {
  for (const Order& order : orders()) {
    open();
    order.prepare();
    static_cast<void>(alive());
    CHECK_TEXT(order.say(stops.count()), order.name);
    CHECK_TEXT(alive() >= 1, order.name);
  }
}

TEST(OperatorControlStop, WhatWasCarriedOutBeforeAStopIsHeededNoMore) {
  for (const Stop stop : k_stops) {
    for (const Order& order : orders()) {
      open();
      order.prepare();
      CHECK_TEXT(order.say(stops.count()), order.name);
      const robot::StopMark going = sut->going();
      (*sut.*stop)("ada");
      LONGS_EQUAL_TEXT(0, alive(), order.name);
      CHECK_TEXT(going.stopped() && sut->cell().going() != Going::Goes && !sut->begin_cycle(), order.name);
      CHECK_TEXT(sut->state()["held"].is_null(), order.name);
      STRCMP_EQUAL("stopped", state("phase").c_str());
    }
  }
}

TEST(OperatorControlStop, WhatWasSaidBeforeAStopAndComesAfterItIsOver) {
  for (const Stop stop : k_stops) {
    for (const Order& order : orders()) {
      open();
      order.prepare();
      const std::uint64_t heard = stops.count();
      (*sut.*stop)("ada");
      static_cast<void>(order.say(heard));
      LONGS_EQUAL_TEXT(0, alive(), order.name);
      CHECK_TEXT(!sut->begin_cycle(), order.name);
      STRCMP_EQUAL("stopped", state("phase").c_str());
      // Nor does the next start, of somebody who has seen the stop, bring it back.
      SUCCEEDS(sut->start({}, {"ada", stops.count()}));
      static_cast<void>(alive());
      static_cast<void>(order.say(heard));
      LONGS_EQUAL_TEXT(0, alive(), order.name);
      CHECK_TEXT(sut->begin_cycle().has_value(), order.name);
    }
  }
}

TEST(OperatorControlStop, AfterAStopOnlyAStartBegins) {
  for (const Stop stop : k_stops) {
    for (const Order& order : orders()) {
      open();
      order.prepare();
      (*sut.*stop)("ada");
      const bool taken = order.say(stops.count());
      if (std::string{order.name} != "a mended line") CHECK_EQUAL_TEXT(order.starts, taken, order.name);
      LONGS_EQUAL_TEXT(order.starts ? 1 : 0, alive(), order.name);
      const std::optional<robot::StopMark> mark = sut->begin_cycle();
      CHECK_EQUAL_TEXT(order.starts, mark.has_value(), order.name);
      if (mark) CHECK_FALSE(mark->stopped());
    }
  }
}

TEST(OperatorControlStop, WhoTakesTheArmAtThePendantEndsWhatWasSaidBefore) {
  for (const Order& order : orders()) {
    open({}, true);
    order.prepare();
    CHECK_TEXT(order.say(stops.count()), order.name);
    const robot::StopMark going = sut->going();
    sut->taken_at_the_pendant();
    LONGS_EQUAL_TEXT(0, alive(), order.name);
    CHECK_TEXT(going.stopped() && sut->cell().going() != Going::Goes && !sut->begin_cycle(), order.name);
    CHECK_TEXT(sut->state()["held"].is_null(), order.name);
    STRCMP_EQUAL("stopped", state("phase").c_str());
    STRCMP_CONTAINS("stopped by somebody at the pendant", state("now").c_str());
  }
  const auto rows = sut->memory().log_rows(0, 1);
  SUCCEEDS(rows);
  STRCMP_EQUAL("stop", rows->front().action.c_str());
  STRCMP_EQUAL("pendant", rows->front().door.c_str());
  // What was in work then is ended by the service.
  sut->works(k_scan);
  sut->enter(CellEvent::Done);
  SUCCEEDS(sut->start({}, {"ada", stops.count()}));
  CHECK(sut->begin_cycle().has_value());
}

TEST(OperatorControlStop, WithoutDoorsGivingTheArmBackIsTheWordToGoOn) {
  open();
  const robot::StopMark before = sut->going();
  sut->taken_at_the_pendant();
  CHECK(before.stopped());
  const std::optional<OperatorCommand> command = sut->next_command();
  CHECK(command && command->kind == OperatorCommand::Kind::Stop);
  const std::optional<robot::StopMark> mark = sut->begin_cycle();
  CHECK(mark && !mark->stopped());
}

TEST(OperatorControlStop, AStopBetweenTheCheckOfTheRobotAndTheAskingIsOne) {
  open();
  SUCCEEDS(sut->start({}, {"ada", stops.count()}));
  CHECK(sut->cell().going() == Going::Goes);
  // As a signal says it: nobody has taken the cell's lock yet.
  stops.stop();
  CHECK(!sut->begin_cycle());
}

TEST(OperatorControlStop, AScanOfBeforeAStopDoesNotWaitForAPerson) {
  open();
  const robot::StopMark mark = sut->going();
  sut->stop("ada");
  hold();
  CHECK(sut->state()["held"].is_null());
  SUCCEEDS(sut->start({}, {"ada", stops.count()}));
  test::hold_worked(*sut, {.scan = k_scan, .waits = Waits::ForWord, .fresh_s = 100, .mark = mark});
  CHECK(sut->state()["held"].is_null());
  FAILS_NAMING(Errc::WrongState, "was stopped", decide(api::Decision::Kind::Accept, stops.count()));
}

TEST(OperatorControlStop, AHeldScanThatAStopEndedSaysSo) {
  open();
  hold();
  sut->stop("ada");
  STRCMP_EQUAL("stopped", state("phase").c_str());
  STRCMP_CONTAINS("stopped by ada; scan-0001 waits no longer", state("now").c_str());
  FAILS_NAMING(Errc::WrongState, "scan-0001 was stopped and waits no longer; start",
               decide(api::Decision::Kind::Accept, stops.count()));
  // A no does not contradict it, and stays.
  SUCCEEDS(decide(api::Decision::Kind::Reject, stops.count()));
  LONGS_EQUAL(0, alive());
}

TEST(OperatorControlStop, AnArmThatComesToRestIsNotCalledStopped) {
  open();
  sut->works(k_scan);
  sut->enter(CellEvent::ArmSetsOut);
  sut->show("the arm follows the line of scan-0001", "the next scan");
  sut->stop("ada");
  STRCMP_EQUAL("following", state("phase").c_str());
  STRCMP_CONTAINS("stopped by ada", state("now").c_str());
}

TEST(OperatorControlStop, AStartOfTheLineThatWaitedPastAStopIsRefusedAlsoAfterAPersonsStart) {
  open({{.number = 1, .model = {}, .process = {}}});
  LONGS_EQUAL(0, static_cast<int>(sut->choose_job(1, false)));
  const std::uint64_t heard = stops.count();
  sut->stop("ada");
  using line_control::Refusal;
  CHECK(sut->start_for_line(5, false, heard).refusal == Refusal::Stopped);
  CHECK(sut->start_for_line(6, false, stops.count()).refusal == Refusal::Stopped);
  SUCCEEDS(sut->start({}, {"ada", stops.count()}));
  sut->give_up_start();
  CHECK(sut->start_for_line(5, false, heard).refusal == Refusal::Stopped);
  CHECK(sut->start_for_line(7, false, stops.count()).refusal == Refusal::None);
  CHECK(sut->begin_cycle().has_value());
}

TEST(OperatorControlStop, APartNumberIsOfTheNextStartWhoeverSaysItAndEndsWithAStop) {
  open({{.number = 1, .model = "boot", .process = {}, .foot = "left", .size = "EU 42"}});
  LONGS_EQUAL(0, static_cast<int>(sut->choose_job(1, false)));
  const auto started = [this] {
    std::optional<OperatorCommand> last;
    while (std::optional<OperatorCommand> command = sut->next_command()) last = std::move(command);
    CHECK(last && last->kind == OperatorCommand::Kind::Start);
    return last->job;
  };
  LONGS_EQUAL(0, static_cast<int>(sut->choose_part("A-17", false)));
  STRCMP_EQUAL("A-17", sut->line_state().next_part.c_str());
  CHECK(sut->start_for_line(5, false, stops.count()).fresh);
  const api::Job job = started();
  STRCMP_EQUAL("A-17", job.part.c_str());
  STRCMP_EQUAL("left", job.foot.c_str());
  STRCMP_EQUAL("EU 42", job.size.c_str());
  sut->give_up_start();
  CHECK(sut->start_for_line(6, false, stops.count()).fresh);
  STRCMP_EQUAL("", started().part.c_str());
  sut->give_up_start();
  // A page's start says nothing of it, then another number.
  LONGS_EQUAL(0, static_cast<int>(sut->choose_part("A-18", false)));
  SUCCEEDS(sut->start({}, {"ada", stops.count()}));
  STRCMP_EQUAL("A-18", started().part.c_str());
  sut->give_up_start();
  LONGS_EQUAL(0, static_cast<int>(sut->choose_part("A-19", false)));
  SUCCEEDS(sut->start({.part = "B-1"}, {"ada", stops.count()}));
  STRCMP_EQUAL("B-1", started().part.c_str());
  sut->give_up_start();
  LONGS_EQUAL(0, static_cast<int>(sut->choose_part("A-20", false)));
  sut->stop("ada");
  STRCMP_EQUAL("", sut->line_state().next_part.c_str());
  LONGS_EQUAL(static_cast<int>(line_control::Refusal::ControlHeld),
              static_cast<int>(sut->choose_part("A-21", true)));
}

TEST(OperatorControlStop, AMendThatAStopMeetsIsOver) {
  open();
  hold();
  SUCCEEDS(sut->begin_mend(k_scan));
  CHECK(sut->mends(k_scan));
  sut->end_mend(k_scan, true, {"ada", stops.count()});
  sut->stop("ada");
  while (const std::optional<OperatorCommand> command = sut->next_command()) {
    if (command->kind != OperatorCommand::Kind::Stop) sut->drop(*command);
  }
  CHECK_FALSE(sut->mends(k_scan));
  // And can be mended as every kept scan, once the service has ended it.
  sut->works(k_scan);
  sut->enter(CellEvent::Done);
  SUCCEEDS(sut->begin_mend(k_scan));
}

TEST(OperatorControlStop, ANoAfterAYesNamesTheStop) {
  using enum api::Decision::Kind;
  for (const api::Decision::Kind yes : {Accept, Send}) {
    open();
    hold();
    SUCCEEDS(decide(yes, 0));
    FAILS_NAMING(Errc::WrongState, "/commands/stop", decide(Reject, 0));
    // Nor while the arm follows a scan that nobody had to accept.
    SUCCEEDS(sut->memory().put_scan(row_named("open"), {}));
    sut->enter(CellEvent::ArmSetsOut);
    FAILS_NAMING(Errc::WrongState, "/commands/stop", decide(Reject, 0));
  }
}

TEST(OperatorControlStop, OfManyWordsAtOnceOneCounts) {
  using enum api::Decision::Kind;
  for (int round = 0; round < 10; ++round) {
    open();
    hold();
    std::atomic<int> yes{0}, no{0};
    std::atomic<bool> go{false};
    std::vector<std::thread> people;
    for (int i = 0; i < 10; ++i) {
      people.emplace_back([&, i] {
        while (!go) std::this_thread::yield();
        const api::Decision::Kind kind = i % 3 == round % 3 ? Reject : i % 2 == 0 ? Accept : Send;
        if (decide(kind, 0)) ++(kind == Reject ? no : yes);
      });
    }
    go = true;
    for (std::thread& person : people) person.join();
    LONGS_EQUAL(1, yes + no);
    const auto row = sut->memory().scan(k_scan);
    SUCCEEDS(row);
    STRCMP_EQUAL(yes == 1 ? "accepted" : "rejected", (*row)->decision.c_str());
    const std::optional<OperatorCommand> command = sut->next_command();
    CHECK(command &&
          command->kind == (yes == 1 ? OperatorCommand::Kind::Send : OperatorCommand::Kind::Reject));
    CHECK(!sut->next_command());
  }
}

/// How long a cell stands still says nothing of a shoe.
TEST(OperatorControlStop, ACycleThatAStopFellIntoIsNoCycleTime) {
  using namespace std::chrono_literals;
  open();
  CHECK(!sut->cycle_s());
  CHECK(sut->begin_cycle().has_value());
  std::this_thread::sleep_for(20ms);
  CHECK(sut->begin_cycle().has_value());
  const double last_s = sut->state()["cycle"]["last_s"].get<double>();
  CHECK(last_s >= 0.02);
  CHECK(sut->cycle_s().has_value());
  for (const auto& stop : std::vector<std::function<void()>>{
           [&] { sut->stop("ada"); }, [&] { sut->laser_off("ada"); }, [&] { sut->taken_at_the_pendant(); }}) {
    stop();
    CHECK(!sut->cycle_s());
    CHECK(sut->state()["cycle"]["this_s"].is_null());
    std::this_thread::sleep_for(20ms);
    SUCCEEDS(sut->start({}, {"ada", stops.count()}));
    CHECK(!sut->cycle_s());
    CHECK(sut->begin_cycle().has_value());
    CHECK(sut->cycle_s().has_value());
    // The last one is still that of the last whole one.
    DOUBLES_EQUAL(last_s, sut->state()["cycle"]["last_s"].get<double>(), 0);
  }
}

/// Whatever the threads' order: after the last stop nothing is alive that was said before it.
TEST(OperatorControlStop, StopsAndOrdersOfManyThreadsLeaveNothingThatWasSaidBefore) {
  open();
  std::atomic<bool> done{false};
  std::vector<std::thread> people;
  for (int i = 0; i < 3; ++i) {
    people.emplace_back([&] {
      while (!done) static_cast<void>(sut->start({}, {"ada", stops.count()}));
    });
  }
  for (int i = 0; i < 200; ++i) {
    const robot::StopMark before = sut->going();
    sut->stop("bob");
    CHECK(before.stopped());
    // A scan that is asked for now comes of a start after the stop.
    if (const auto mark = sut->begin_cycle()) CHECK_FALSE(mark->stopped());
  }
  done = true;
  for (std::thread& person : people) person.join();
  sut->stop("bob");
  LONGS_EQUAL(0, alive());
  CHECK(sut->cell().going() != Going::Goes && !sut->begin_cycle());
}

}  // namespace biteline::service
