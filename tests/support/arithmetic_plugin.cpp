// SPDX-License-Identifier: MIT
#include "tests/support/arithmetic_plugin.hpp"

#include <CppUTest/TestFailure.h>
#include <CppUTest/TestResult.h>
#include <execinfo.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cfenv>
#include <csignal>
#include <cstdio>
#include <string>

namespace biteline::test {
namespace {

constexpr int k_watched = FE_DIVBYZERO | FE_OVERFLOW | FE_UNDERFLOW | FE_INVALID;

std::string names_of(int flags) {
  std::string names;
  if (flags & FE_DIVBYZERO) names += " FE_DIVBYZERO";
  if (flags & FE_OVERFLOW) names += " FE_OVERFLOW";
  if (flags & FE_UNDERFLOW) names += " FE_UNDERFLOW";
  if (flags & FE_INVALID) names += " FE_INVALID";
  return names;
}

void print_calls(int /*signal*/) {
  std::array<void*, 40> calls{};
  backtrace_symbols_fd(calls.data(), backtrace(calls.data(), calls.size()), STDERR_FILENO);
  _exit(1);
}

/// Runs the test in a child process that stops at the first operation that raises one of the flags.
void print_where(UtestShell& test, TestResult& result, int flags) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) return;
  if (child > 0) {
    waitpid(child, nullptr, 0);
    return;
  }
  alarm(120);  // a test with threads of its own may wait for them for ever
  std::signal(SIGFPE, print_calls);
  feenableexcept(flags);
  test.runOneTestInCurrentProcess(NullTestPlugin::instance(), result);
  _exit(0);
}

}  // namespace

void ArithmeticPlugin::preTestAction(UtestShell& /*test*/, TestResult& /*result*/) {
  std::feclearexcept(FE_ALL_EXCEPT);
}

void ArithmeticPlugin::postTestAction(UtestShell& test, TestResult& result) {
  const int first = std::fetestexcept(k_watched);
  if (first == 0 || test.hasFailed()) return;
  std::feclearexcept(FE_ALL_EXCEPT);
  test.runOneTestInCurrentProcess(NullTestPlugin::instance(), result);
  const int again = std::fetestexcept(k_watched);
  if (test.hasFailed()) return;
  if (again == 0) {
    std::fprintf(stderr, "%s:%s was raised, and not when it ran again: not by this test\n",
                 test.getFormattedName().asCharString(), names_of(first).c_str());
    return;
  }
  std::feclearexcept(FE_ALL_EXCEPT);
  print_where(test, result, again);
  result.addFailure(TestFailure(&test, ("the test raises" + names_of(again)).c_str()));
}

}  // namespace biteline::test
