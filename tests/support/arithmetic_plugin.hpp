// SPDX-License-Identifier: MIT
#pragma once
/// \file A test that makes a NaN, divides by zero, overflows or underflows fails.
///
/// A computation raises the same flags each time it runs.  A flag that the same test does not raise again
/// came from outside of it: once, a virtual machine raised one in a test that had never raised any.

#include <CppUTest/TestHarness.h>
#include <CppUTest/TestPlugin.h>

namespace biteline::test {

/// Looks at the arithmetic flags of the thread that runs the tests (the C standard's <fenv.h>, section 7.6).
/// A test that raised one is run again.  If it raises one again, it fails, and a third run in a child process
/// prints the calls that lead to the first such operation.  If not, one line says so.
class ArithmeticPlugin : public TestPlugin {
 public:
  ArithmeticPlugin() : TestPlugin{"Arithmetic"} {}
  void preTestAction(UtestShell& test, TestResult& result) override;
  void postTestAction(UtestShell& test, TestResult& result) override;
};

}  // namespace biteline::test
