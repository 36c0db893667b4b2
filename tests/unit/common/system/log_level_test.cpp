// SPDX-License-Identifier: MIT
// Lines carry their level where the journal reads them, and nowhere else.
#include "common/system/log_level.hpp"

#include <sys/stat.h>

#include <CppUTest/TestHarness.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace biteline {

TEST_GROUP(LogLevels) {
  std::FILE* stream = std::tmpfile();
  void teardown() override {
    ::unsetenv("JOURNAL_STREAM");
    std::fclose(stream);
  }
  /// As systemd names a stream.
  static void name_journal(std::FILE * of, unsigned long long further = 0) {
    struct stat file {};
    LONGS_EQUAL(0, ::fstat(::fileno(of), &file));
    const std::string name = std::to_string(file.st_dev) + ":" + std::to_string(file.st_ino + further);
    ::setenv("JOURNAL_STREAM", name.c_str(), 1);
  }
  const char* prefix(LogLevel level) {
    return level_prefix(::fileno(stream), level);
  }
};

TEST(LogLevels, TheJournalIsToldTheLevel) {
  name_journal(stream);
  STRCMP_EQUAL("<3>", prefix(LogLevel::Error));
  STRCMP_EQUAL("<4>", prefix(LogLevel::Warning));
  STRCMP_EQUAL("<6>", prefix(LogLevel::Info));
}

TEST(LogLevels, APersonOrAFileIsNot) {
  STRCMP_EQUAL("", prefix(LogLevel::Error));
  name_journal(stream, 1);  // its output was led elsewhere
  STRCMP_EQUAL("", prefix(LogLevel::Error));
  for (const char* spoiled : {"", "x", "12", ":", "-1:-1"}) {
    ::setenv("JOURNAL_STREAM", spoiled, 1);
    STRCMP_EQUAL("", prefix(LogLevel::Error));
  }
}

TEST(LogLevels, AStreamThatIsClosedIsNoJournal) {
  name_journal(stream);
  STRCMP_EQUAL("", level_prefix(-1, LogLevel::Error));
}

}  // namespace biteline
