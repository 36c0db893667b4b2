// SPDX-License-Identifier: MIT
#include "host/records/batch/limited_process.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::batch {

TEST_GROUP(LimitedProcess) {
  test::TemporaryFolder folder;

  ProcessEnd run(const std::string& script, const ProcessLimits& limits) {
    const auto end = run_limited("/bin/sh", {"-c", script}, folder.path(), limits);
    SUCCEEDS(end);
    return *end;
  }
};

TEST(LimitedProcess, SaysStatusAndLastWords) {
  const ProcessEnd end = run("echo first >&2; echo; echo 'the last' >&2; exit 3", {});
  CHECK(end.how == ProcessEnd::How::Exited);
  LONGS_EQUAL(3, end.status);
  STRCMP_EQUAL("the last", end.last_words.c_str());
}

TEST(LimitedProcess, NamesTheSignalOfACrash) {
  const ProcessEnd end = run("kill -SEGV $$", {});
  CHECK(end.how == ProcessEnd::How::Signalled);
  LONGS_EQUAL(SIGSEGV, end.status);
}

TEST(LimitedProcess, KillsWhatHangsAndAllThatItStarted) {
  const std::string pid_file = (folder.path() / "pid").string();
  const ProcessEnd end =
      run("sleep 1000 & echo $! > " + pid_file + "; wait", {.time_s = 0.5, .memory_mb = 1000});
  CHECK(end.how == ProcessEnd::How::TimedOut);
  int pid = 0;
  CHECK((std::ifstream(pid_file) >> pid).good() || pid > 0);
  // Its new parent reaps it when it gets to it: until then it is a zombie, which is as dead.
  const auto dead = [&] {
    std::string state;
    std::ifstream status("/proc/" + std::to_string(pid) + "/stat");
    std::string number, name;
    status >> number >> name >> state;
    return state.empty() || state == "Z" || state == "X";
  };
  for (int i = 0; i < 1000 && !dead(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds{10});
  CHECK(dead());
}

TEST(LimitedProcess, GivesNoMoreMemoryThanAllowed) {
  // tail keeps what may be its last line: 200 MB without an end of line.
  const std::string eat = "head -c 200000000 /dev/zero | tail -n 1 > /dev/null";
  LONGS_EQUAL(0, run(eat, {.time_s = 600, .memory_mb = 4000}).status);
  CHECK(run(eat, {.time_s = 600, .memory_mb = 50}).status != 0);
}

TEST(LimitedProcess, FailsWithTheNameOfAMissingProgram) {
  FAILS_NAMING(Errc::FileNotFound, "/no/program", run_limited("/no/program", {}, folder.path(), {}));
}

}  // namespace biteline::batch
