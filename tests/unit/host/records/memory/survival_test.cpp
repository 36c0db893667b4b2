// SPDX-License-Identifier: MIT
// The memory when its process is killed and when the disk is full.
#include <CppUTest/TestHarness.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

#include "host/records/memory/memory.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::memory {
namespace {

Scan numbered(int number) {
  Scan scan;
  scan.name = "scan-" + std::to_string(number);
  scan.time = number;
  scan.verdict = "ok";
  scan.details = std::string(2000, 'd');
  return scan;
}

LogRow result_of(int number) {
  LogRow row;
  row.who = "service";
  row.action = "result";
  row.subject = "scan-" + std::to_string(number);
  return row;
}

/// Rows and events belong together, and SQLite finds its file whole.
void check_whole(const std::filesystem::path& file, int at_least) {
  auto memory = Memory::open(file);
  SUCCEEDS(memory);
  auto database = Database::open(file, Database::Access::ReadWrite);
  SUCCEEDS(database);
  auto check = database->prepare("PRAGMA integrity_check");
  SUCCEEDS(check);
  SUCCEEDS(check->step());
  STRCMP_EQUAL("ok", check->text(0).c_str());
  // A scan that was stored and not yet told is put once more by the next round: two events, one row.
  auto counts =
      database->prepare("SELECT (SELECT count(*) FROM scans), (SELECT count(DISTINCT subject) FROM log)");
  SUCCEEDS(counts);
  SUCCEEDS(counts->step());
  LONGS_EQUAL(counts->integer(0), counts->integer(1));
  CHECK(counts->integer(0) >= at_least);
}

}  // namespace

TEST_GROUP(MemorySurvives){};

TEST(MemorySurvives, KillAtAnyMomentLosesNothingThatWasTold) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / k_memory_file;
  int told = 0;
  for (int round = 0; round < 5; ++round) {
    int pipe_ends[2];
    CHECK(::pipe(pipe_ends) == 0);
    const pid_t child = ::fork();
    if (child == 0) {
      auto memory = Memory::open(file);
      for (int number = told + 1; memory; ++number) {
        if (!memory->put_scan(numbered(number), result_of(number))) break;
        if (::write(pipe_ends[1], &number, sizeof number) != sizeof number) break;
      }
      ::_exit(1);
    }
    ::close(pipe_ends[1]);
    // Some are told, then it dies in the middle of whatever it does.
    const int until = told + 3 + 4 * round;
    int number = 0;
    while (told < until && ::read(pipe_ends[0], &number, sizeof number) == sizeof number) told = number;
    ::kill(child, SIGKILL);
    while (::read(pipe_ends[0], &number, sizeof number) == sizeof number) told = number;
    ::close(pipe_ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    CHECK(WIFSIGNALED(status));
    check_whole(file, told);
  }
}

TEST(MemorySurvives, FullDiskIsToldAndTheNextOneFitsAgain) {
  const test::TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    // In a mount namespace of its own: a small disk that nobody else sees.
    if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=1m") != 0)
      ::_exit(77);
    auto memory = Memory::open(folder.path() / k_memory_file);
    if (!memory) ::_exit(1);
    int stored = 0;
    Result<void> put{};
    while (stored < 5000 && (put = memory->put_scan(numbered(stored + 1), result_of(stored + 1)))) ++stored;
    if (put || put.error().code != Errc::DiskFull || stored == 0) ::_exit(2);
    if (memory->scan(numbered(stored + 1).name)->has_value()) ::_exit(3);  // nothing half
    if (!memory->scan(numbered(stored).name)->has_value()) ::_exit(4);
    // Room again: no restart is needed.
    if (::mount("tmpfs", folder.path().c_str(), "tmpfs", MS_REMOUNT, "size=4m") != 0) ::_exit(77);
    if (!memory->put_scan(numbered(stored + 1), result_of(stored + 1))) ::_exit(5);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) {
    std::puts("skipped: a disk of its own needs root");
    return;
  }
  LONGS_EQUAL(0, WEXITSTATUS(status));
}

}  // namespace biteline::memory
