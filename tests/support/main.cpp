// SPDX-License-Identifier: MIT
// Runs the tests of one executable.  Exit 0: passed; 1: failed; 77: skipped (tests/support/shared_data.hpp).
#include <CppUTest/CommandLineTestRunner.h>
#include <CppUTest/MemoryLeakWarningPlugin.h>
#include <CppUTest/TestRegistry.h>

#include "tests/support/arithmetic_plugin.hpp"
#include "tests/support/shared_data.hpp"

int main(int argc, char** argv) {
  // Our own sanitizer build finds leaks; CppUTest's detector trips over library-lifetime allocations.  Its
  // plugin, which RunAllTests() would install, walks what libraries allocated before main() and freed since.
  MemoryLeakWarningPlugin::turnOffNewDeleteOverloads();
  // Missing data is a flag, never a NaN.
  biteline::test::ArithmeticPlugin arithmetic;
  TestRegistry::getCurrentRegistry()->installPlugin(&arithmetic);
  // The runner returns the number of failures, which wraps at 256 and collides with 77.
  CommandLineTestRunner runner{argc, argv, TestRegistry::getCurrentRegistry()};
  const int failures = runner.runAllTestsMain();
  if (failures != 0) return 1;
  return biteline::test::everything_was_skipped() ? 77 : 0;
}
