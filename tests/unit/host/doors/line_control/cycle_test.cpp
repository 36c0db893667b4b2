// SPDX-License-Identifier: MIT
// Each start is one scan, people come first, and nothing is started twice.
#include "host/doors/line_control/cycle.hpp"

#include <CppUTest/TestHarness.h>

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
