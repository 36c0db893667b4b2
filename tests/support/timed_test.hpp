// SPDX-License-Identifier: MIT
#pragma once
/// \file Tests whose subject must keep a time: TIMED_TEST or ORDINARY_TIMED_TEST in place of TEST.
///
/// A check that fails on a machine that woke everybody in time is a failure, at once and for good.  One that
/// fails while the machine itself stood still for longer than the subject allows says nothing: the test is
/// run again, and after some such runs skipped, with the delay that was measured.

#include <CppUTest/TestHarness.h>

#include <optional>
#include <string>

#include "tests/support/wakeup_probe.hpp"

namespace biteline::test {

/// What the tightest of the laser guard's limits leaves for the machine: 50 ms without a sign of life of the
/// frame thread, less its turn of 20 ms and a frame of 5 ms.
/// Counted within 100 ms: several short delays in a row are as good as a long one.
constexpr double k_machine_late_ms = 25;

class TimedTestShell : public UtestShell {
 public:
  explicit TimedTestShell(WakeupProbe::Rank rank) : rank_{rank} {}
  void runOneTest(TestPlugin* plugin, TestResult& result) override;
  void failWith(const TestFailure& failure) override;
  void failWith(const TestFailure& failure, const TestTerminator& terminator) override;

  /// Of the test that runs.
  [[nodiscard]] static const WakeupProbe& probe();

 private:
  WakeupProbe::Rank rank_;
  std::optional<std::string> late_failure_;  ///< what failed while the machine stood still
};

/// Milliseconds from one instant to another, less those in which the machine stood still.
[[nodiscard]] double reaction_ms(WakeupProbe::Clock::time_point from, WakeupProbe::Clock::time_point until);

}  // namespace biteline::test

/// The subject has threads with real-time rights (the sensor): the machine is late when it holds those up.
#define TIMED_TEST(testGroup, testName) BITELINE_TIMED_TEST(testGroup, testName, Urgent)
/// The subject has ordinary threads alone (the host): what other programs take from them counts as late, too.
#define ORDINARY_TIMED_TEST(testGroup, testName) BITELINE_TIMED_TEST(testGroup, testName, Ordinary)

#define BITELINE_TIMED_TEST(testGroup, testName, probeRank)                                       \
  class TIMED_##testGroup##_##testName##_Test : public TEST_GROUP_##CppUTestGroup##testGroup {    \
   public:                                                                                        \
    void testBody() override;                                                                     \
  };                                                                                              \
  static class TIMED_##testGroup##_##testName##_Shell : public ::biteline::test::TimedTestShell { \
   public:                                                                                        \
    TIMED_##testGroup##_##testName##_Shell()                                                      \
        : TimedTestShell{::biteline::test::WakeupProbe::Rank::probeRank} {}                       \
    Utest* createTest() override { return new TIMED_##testGroup##_##testName##_Test; }            \
  } TIMED_##testGroup##_##testName##_instance;                                                    \
  static TestInstaller TIMED_##testGroup##_##testName##_installer(                                \
      TIMED_##testGroup##_##testName##_instance, #testGroup, #testName, __FILE__, __LINE__);      \
  void TIMED_##testGroup##_##testName##_Test::testBody()
