// SPDX-License-Identifier: MIT
#include "tests/support/arithmetic_plugin.hpp"

#include <CppUTest/TestHarness.h>
#include <CppUTest/TestTestingFixture.h>

#include <cfenv>

namespace biteline::test {
namespace {

int g_runs = 0;

void sound() {
  ++g_runs;
}
void raises_always() {
  ++g_runs;
  std::feraiseexcept(FE_INVALID);
}
void raises_once() {
  if (++g_runs == 1) std::feraiseexcept(FE_INVALID);
}

TEST_GROUP(ArithmeticPlugin) {
  test::ArithmeticPlugin plugin;
  TestTestingFixture fixture;
  void setup() override {
    g_runs = 0;
    fixture.installPlugin(&plugin);
  }
};

TEST(ArithmeticPlugin, ATestThatRaisesNothingRunsOnce) {
  fixture.runTestWithMethod(sound);
  CHECK(!fixture.hasTestFailed());
  LONGS_EQUAL(1, g_runs);
}

TEST(ArithmeticPlugin, AFlagThatComesAgainIsAFailureThatNamesIt) {
  fixture.runTestWithMethod(raises_always);
  LONGS_EQUAL(1, fixture.getFailureCount());
  fixture.assertPrintContains("the test raises FE_INVALID");
  LONGS_EQUAL(2, g_runs);  // the third is a child's
}

TEST(ArithmeticPlugin, AFlagThatDoesNotComeAgainIsNotTheTestsOwn) {
  fixture.runTestWithMethod(raises_once);
  CHECK(!fixture.hasTestFailed());
  LONGS_EQUAL(2, g_runs);
}

}  // namespace
}  // namespace biteline::test
