// SPDX-License-Identifier: MIT
#include "common/system/log_level.hpp"

#include <sys/stat.h>

#include <cstdio>
#include <cstdlib>

namespace biteline {

const char* level_prefix(int fd, LogLevel level) {
  const char* stream = std::getenv("JOURNAL_STREAM");
  unsigned long long device = 0;
  unsigned long long inode = 0;
  if (stream == nullptr || std::sscanf(stream, "%llu:%llu", &device, &inode) != 2) return "";
  struct stat file {};
  if (::fstat(fd, &file) != 0 || file.st_dev != device || file.st_ino != inode) return "";
  switch (level) {
    case LogLevel::Error:
      return "<3>";
    case LogLevel::Warning:
      return "<4>";
    case LogLevel::Info:
      return "<6>";
  }
  return "";
}

}  // namespace biteline
