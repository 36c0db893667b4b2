// SPDX-License-Identifier: MIT
#include "host/intake/child_process.hpp"

#include <CppUTest/TestHarness.h>

#include <csignal>

#include "tests/support/errors.hpp"

namespace biteline::intake {

using namespace std::chrono_literals;

TEST_GROUP(ChildProcess){static Result<ChildProcess> shell(const std::string& script){
    return ChildProcess::start({.program = "/bin/sh", .arguments = {"-c", script}});
}  // namespace biteline::intake
}
;

TEST(ChildProcess, LinesAndExitStatusArrive) {
  auto sut = shell("echo one; echo two; exit 3");
  SUCCEEDS(sut);
  STRCMP_EQUAL("one", sut->next_line(10s)->c_str());
  STRCMP_EQUAL("two", sut->next_line(10s)->c_str());
  LONGS_EQUAL(3, *sut->wait(10s));
  CHECK(!sut->running());
}

TEST(ChildProcess, LastWordsNameTheReasonOfADeath) {
  auto sut = shell("echo first >&2; echo 'camera lost' >&2; exit 4");
  LONGS_EQUAL(4, *sut->wait(10s));
  STRCMP_EQUAL("camera lost", sut->last_words().c_str());
  FAILS_NAMING(Errc::ProcessDied, "camera lost", sut->next_line(10s));
}

TEST(ChildProcess, SilenceIsATimeoutAndStopEndsIt) {
  auto sut = shell("exec sleep 60");
  FAILS_NAMING(Errc::Timeout, "sh", sut->next_line(1ms));
  CHECK(sut->running());
  LONGS_EQUAL(128 + SIGTERM, sut->stop());
}

TEST(ChildProcess, OneThatIgnoresSigtermIsKilled) {
  auto sut = shell("trap '' TERM; echo ready; while :; do sleep 60; done");
  STRCMP_EQUAL("ready", sut->next_line(10s)->c_str());
  LONGS_EQUAL(128 + SIGKILL, sut->stop(1ms));
}

TEST(ChildProcess, EndsWithItsOwner) {
  int pid = 0;
  {
    auto sut = shell("exec sleep 60");
    pid = sut->pid();
    LONGS_EQUAL(0, ::kill(pid, 0));
  }
  LONGS_EQUAL(-1, ::kill(pid, 0));
}

TEST(ChildProcess, MissingProgramIsNamed) {
  FAILS_NAMING(Errc::FileNotFound, "no-such-program",
               ChildProcess::start({.program = "/no-such-program", .arguments = {}}));
}

}  // namespace biteline::intake
