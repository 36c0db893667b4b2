// SPDX-License-Identifier: MIT
// A machine that was suspended: a scan has grown older meanwhile.
#include <CppUTest/TestHarness.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <ctime>

#include "host/apps/biteline-host/service_words.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::service {
namespace {

constexpr int k_no_namespaces = 77, k_suspended_s = 100'000;

std::int64_t seconds_of(clockid_t clock) {
  std::timespec time{};
  ::clock_gettime(clock, &time);
  return time.tv_sec;
}

/// Of a child whose machine has been suspended for a day and more: how much older all is by now().
int in_a_suspended_machine() {
  if (::unshare(CLONE_NEWUSER | CLONE_NEWTIME) != 0 && ::unshare(CLONE_NEWTIME) != 0) return k_no_namespaces;
  const int offsets = ::open("/proc/self/timens_offsets", O_WRONLY | O_CLOEXEC);
  const std::string text = "boottime " + std::to_string(k_suspended_s) + " 0";
  if (offsets < 0 || ::write(offsets, text.data(), text.size()) < 0) return k_no_namespaces;
  ::close(offsets);
  // It is for the children.
  const pid_t child = ::fork();
  if (child == 0) {
    const std::int64_t now_s =
        std::chrono::duration_cast<std::chrono::seconds>(now().time_since_epoch()).count();
    ::_exit(now_s - seconds_of(CLOCK_MONOTONIC) >= k_suspended_s - 10 ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WEXITSTATUS(status);
}

}  // namespace

TEST_GROUP(ServiceTime){};

TEST(ServiceTime, AgesGoOnWhileTheMachineIsSuspended) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(in_a_suspended_machine());
  int status = 0;
  LONGS_EQUAL(child, ::waitpid(child, &status, 0));
  if (WEXITSTATUS(status) == k_no_namespaces) return test::note_skipped("no namespaces of time here");
  LONGS_EQUAL(0, WEXITSTATUS(status));
  test::note_ran();
}

}  // namespace biteline::service
