// SPDX-License-Identifier: MIT
// Each start is one scan, people come first, and nothing is started twice.
#include "host/interfaces/line_control/cycle.hpp"

#include <CppUTest/TestHarness.h>

#include <tuple>

namespace biteline::line_control {

TEST_GROUP(Cycle) {
  Cycle sut{{{.number = 1, .model = "", .process = ""}, {.number = 4, .model = "boot", .process = "grind"}}};
  Standing standing{};

  void check_start(Refusal expected, int request) {
    LONGS_EQUAL(static_cast<int>(expected), static_cast<int>(sut.start(request, standing).refusal));
  }
  void check_choose(Refusal expected, int number) {
    LONGS_EQUAL(static_cast<int>(expected), static_cast<int>(sut.choose(number, standing)));
  }
  void check_part(Refusal expected, const char* part) {
    LONGS_EQUAL(static_cast<int>(expected), static_cast<int>(sut.choose_part(part, standing)));
  }
  LineState state() const {
    return sut.state(standing, Step::Working, false);
  }
  static Ended ended(const char* verdict) {
    return {.scan = "scan-0012",
            .verdict = verdict,
            .model = "boot",
            .sent = true,
            .followed = true,
            .length_mm = 801.4,
            .u95_mm = 0.123,
            .confidence = 0.987};
  }
};

TEST(Cycle, StartIsOneScanWithTheChosenJob) {
  check_start(Refusal::NoJob, 1);
  check_choose(Refusal::UnknownJob, 2);
  check_choose(Refusal::None, 4);
  const Cycle::Start start = sut.start(1, standing);
  CHECK(start.go.has_value());
  STRCMP_EQUAL("boot", start.go->model.c_str());
  CHECK(state().busy);
  LONGS_EQUAL(static_cast<int>(Step::Scanning), static_cast<int>(state().step));
  check_start(Refusal::Busy, 2);
  check_choose(Refusal::Busy, 1);
  sut.scan_begins();
  LONGS_EQUAL(static_cast<int>(Step::Working), static_cast<int>(state().step));
  sut.scan_ends(ended("ok"));
  CHECK(state().done);
  CHECK(!state().busy);
  LONGS_EQUAL(1, state().finished);
  LONGS_EQUAL(4, state().model);
  LONGS_EQUAL(12, state().scan);
  LONGS_EQUAL(1, state().counts.ok);
  check_start(Refusal::None, 2);
  CHECK(!state().done);
}

TEST(Cycle, SameRequestNeverStartsTwice) {
  check_choose(Refusal::None, 1);
  check_start(Refusal::None, 9);
  CHECK(!sut.start(9, standing).go.has_value());
  sut.scan_begins();
  check_start(Refusal::None, 9);
  sut.scan_ends(ended("refused"));
  check_start(Refusal::None, 9);
  CHECK(!state().busy);
  LONGS_EQUAL(1, state().counts.starts);
  // Also when a scan that nobody asked for came between.
  sut.scan_begins();
  sut.scan_ends(ended("ok"));
  LONGS_EQUAL(0, state().finished);
  CHECK(!sut.start(9, standing).go.has_value());
}

TEST(Cycle, PeopleComeFirst) {
  check_choose(Refusal::None, 1);
  standing.control_held = true;
  check_start(Refusal::ControlHeld, 1);
  check_choose(Refusal::ControlHeld, 4);
  // A control that says all its registers each turn is not in anybody's way.
  check_choose(Refusal::None, 1);
  standing = {.stopped = true};
  check_start(Refusal::Stopped, 1);
  LONGS_EQUAL(static_cast<int>(Step::Stopped), static_cast<int>(state().step));
  standing = {.deciding = true};
  check_start(Refusal::Deciding, 1);
  LONGS_EQUAL(static_cast<int>(Step::Deciding), static_cast<int>(state().step));
  standing = {.sensor = false};
  check_start(Refusal::NotReady, 1);
  LONGS_EQUAL(static_cast<int>(Step::Fault), static_cast<int>(state().step));
  standing = {};
  check_start(Refusal::None, 1);
}

TEST(Cycle, WhatDoesNotComeIsGivenUpAndWhatIsInWorkIsNot) {
  check_choose(Refusal::None, 1);
  check_start(Refusal::None, 3);
  sut.give_up();
  CHECK(state().done);
  LONGS_EQUAL(3, state().finished);
  LONGS_EQUAL(static_cast<int>(Verdict::Failed), static_cast<int>(state().verdict));
  check_start(Refusal::None, 4);
  sut.scan_begins();
  sut.give_up();
  CHECK(state().busy);
  sut.scan_ends(ended("failed"));
  LONGS_EQUAL(4, state().finished);
  LONGS_EQUAL(2, state().counts.failed);
}

TEST(Cycle, StartOfAPageIsOneOfTheSameMachine) {
  check_choose(Refusal::None, 1);
  sut.begin(0);
  check_start(Refusal::Busy, 8);
  sut.scan_begins();
  sut.scan_ends(ended("amber"));
  LONGS_EQUAL(0, state().finished);
  LONGS_EQUAL(1, state().counts.amber);
  check_start(Refusal::None, 8);
}

TEST(Cycle, ALineThatAPersonMustSettleHasAVerdictOfItsOwn) {
  check_choose(Refusal::None, 1);
  check_start(Refusal::None, 7);
  sut.scan_begins();
  sut.scan_ends(ended("review"));
  CHECK(state().verdict == Verdict::Review);
  LONGS_EQUAL(1, state().counts.review);
  LONGS_EQUAL(0, state().counts.ok + state().counts.amber + state().counts.refused + state().counts.failed);
}

TEST(Cycle, APartNumberIsOfTheNextStartAndOfNoOther) {
  check_choose(Refusal::None, 4);
  check_part(Refusal::None, "A-17");
  STRCMP_EQUAL("A-17", state().next_part.c_str());
  const Cycle::Start start = sut.start(1, standing);
  STRCMP_EQUAL("A-17", start.part.c_str());
  // As a control that says all of it each turn; another shoe waits until this one is done.
  check_part(Refusal::None, "A-17");
  check_part(Refusal::Busy, "A-18");
  check_part(Refusal::Busy, "");
  STRCMP_EQUAL("A-17", state().next_part.c_str());
  sut.scan_begins();
  Ended of_it = ended("ok");
  of_it.part = "A-17";
  sut.scan_ends(of_it);
  STRCMP_EQUAL("A-17", state().part.c_str());
  STRCMP_EQUAL("", state().next_part.c_str());
  STRCMP_EQUAL("", sut.start(2, standing).part.c_str());
}

TEST(Cycle, APartNumberMeetsTheSameChecksAsAJob) {
  standing.control_held = true;
  check_part(Refusal::ControlHeld, "A-17");
  check_part(Refusal::None, "");
  standing = {.stopped = true};
  check_part(Refusal::None, "A-17");
  // A stop ends what was said before it.
  sut.forget_part();
  STRCMP_EQUAL("", state().next_part.c_str());
}

TEST(Cycle, APagesStartTakesTheLinesPartNumberUnlessItBringsItsOwn) {
  check_part(Refusal::None, "A-17");
  STRCMP_EQUAL("A-17", sut.begin(0).c_str());
  sut.scan_begins();
  sut.scan_ends(ended("ok"));
  check_part(Refusal::None, "A-18");
  STRCMP_EQUAL("B-1", sut.begin(0, "B-1").c_str());
  sut.give_up();
  STRCMP_EQUAL("", state().next_part.c_str());
  STRCMP_EQUAL("", state().part.c_str());
}

TEST(Cycle, AShoeThatIsScannedAgainLeavesTheNextOnesPartNumber) {
  check_part(Refusal::None, "A-17");
  static_cast<void>(sut.begin(0));
  sut.scan_begins();
  sut.scan_ends(ended("refused"));
  check_part(Refusal::None, "A-18");
  sut.begin_again();
  STRCMP_EQUAL("A-17", state().next_part.c_str());
  sut.scan_begins();
  sut.scan_ends(ended("ok"));
  STRCMP_EQUAL("A-18", state().next_part.c_str());
}

TEST(Cycle, ModelIsTheJobOfTheScansFootAndSize) {
  sut = Cycle{{{.number = 1, .model = "boot", .process = {}, .foot = "left", .size = "EU 41"},
               {.number = 2, .model = "boot", .process = {}, .foot = "left", .size = "EU 42"},
               {.number = 3, .model = "boot", .process = {}, .foot = "right"}}};
  for (const auto& [foot, size, number] : {std::tuple{"left", "EU 42", 2}, std::tuple{"right", "EU 41", 3},
                                           std::tuple{"left", "EU 43", 0}, std::tuple{"", "", 0}}) {
    sut.scan_begins();
    Ended of_it = ended("ok");
    of_it.foot = foot;
    of_it.size = size;
    sut.scan_ends(of_it);
    LONGS_EQUAL(number, state().model);
  }
}

TEST(Cycle, RequestOutOfRangeIsNone) {
  check_choose(Refusal::None, 1);
  for (const int request : {0, -1, 65536}) check_start(Refusal::BadRequest, request);
  check_start(Refusal::None, 65535);
}

TEST(Cycle, RowOfAScanThatIsOverChangesNothing) {
  sut.scan_begins();
  sut.scan_ends(ended("ok"));
  sut.scan_ends(ended("refused"));
  LONGS_EQUAL(static_cast<int>(Verdict::Ok), static_cast<int>(state().verdict));
  LONGS_EQUAL(0, state().counts.refused);
}

}  // namespace biteline::line_control
