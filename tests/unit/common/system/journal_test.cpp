// SPDX-License-Identifier: MIT
#include "common/system/journal.hpp"

#include <CppUTest/TestHarness.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace biteline {
namespace {

/// What a program says whose stdout and stderr are one pipe; `journal`: and the journal is told to be it.
std::string said_by(bool journal, void (*program)()) {
  int ends[2];
  LONGS_EQUAL(0, ::pipe(ends));
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(ends[1], STDOUT_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    struct stat status {};
    ::fstat(STDOUT_FILENO, &status);
    const std::string name =
        std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino + (journal ? 0 : 1));
    ::setenv("JOURNAL_STREAM", name.c_str(), 1);
    mark_for_journal();
    program();
    std::fflush(nullptr);
    ::_exit(0);
  }
  ::close(ends[1]);
  std::string said;
  char bytes[256];
  for (ssize_t got = 1; got > 0;) {
    got = ::read(ends[0], bytes, sizeof bytes);
    if (got > 0) said.append(bytes, static_cast<std::size_t>(got));
  }
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return said;
}

}  // namespace

TEST_GROUP(Journal){};

TEST(Journal, EachLineHasItsPriority) {
  STRCMP_EQUAL("<6>scan-0001 begins\n<4>refused: too short\n<3>biteline-host: disk full\n<6>two\n<6>lines\n",
               said_by(true, [] {
                 std::printf("scan-%04d begins\n", 1);
                 std::printf("refused: too short\n");
                 std::fprintf(stderr, "biteline-host: disk full\n");
                 std::printf("two\nlines\n");
               }).c_str());
}

TEST(Journal, ALineInPiecesIsMarkedOnce) {
  STRCMP_EQUAL("<6>one line\n<6>and more", said_by(true, [] {
                                             std::printf("one ");
                                             std::fflush(stdout);
                                             std::printf("line\nand");
                                             std::fflush(stdout);
                                             std::printf(" more");
                                           }).c_str());
}

TEST(Journal, LongLinesComeWhole) {
  const std::string said =
      said_by(true, [] { std::fprintf(stderr, "%s\n", std::string(100'000, 'x').c_str()); });
  LONGS_EQUAL(3 + 100'000 + 1, said.size());
  CHECK(said.starts_with("<3>xxx"));
  CHECK(said.find('<', 1) == std::string::npos);
}

TEST(Journal, ElsewhereNothingChanges) {
  STRCMP_EQUAL("plain\n", said_by(false, [] { std::fprintf(stderr, "plain\n"); }).c_str());
}

}  // namespace biteline
