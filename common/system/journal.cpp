// SPDX-License-Identifier: MIT
#include "common/system/journal.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace biteline {
namespace {

/// A stream in the place of stdout or stderr.
struct Marked {
  int fd;
  std::string_view mark;
  bool line_begins{true};
};
Marked g_out{.fd = STDOUT_FILENO, .mark = "<6>"};
Marked g_error{.fd = STDERR_FILENO, .mark = "<3>"};

bool goes_to_journal(int fd) {
  const char* const told = std::getenv("JOURNAL_STREAM");
  unsigned long long device = 0, inode = 0;
  struct stat status {};
  return told != nullptr && std::sscanf(told, "%llu:%llu", &device, &inode) == 2 &&
         ::fstat(fd, &status) == 0 && status.st_dev == device && status.st_ino == inode;
}

bool write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

ssize_t write_marked(void* cookie, const char* bytes, std::size_t size) {
  constexpr std::string_view k_refused = "refused", k_warning = "<4>";
  auto& stream = *static_cast<Marked*>(cookie);
  std::string_view text{bytes, size};
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end == std::string_view::npos ? end : end + 1);
    const bool warns = stream.fd == STDOUT_FILENO && line.starts_with(k_refused);
    if (stream.line_begins && !write_all(stream.fd, warns ? k_warning : stream.mark)) return 0;
    if (!write_all(stream.fd, line)) return 0;
    stream.line_begins = end != std::string_view::npos;
    text.remove_prefix(line.size());
  }
  return static_cast<ssize_t>(size);
}

void replace(std::FILE*& stream, Marked& marked) {
  if (!goes_to_journal(marked.fd)) return;
  std::FILE* const made = ::fopencookie(
      &marked, "w", {.read = nullptr, .write = write_marked, .seek = nullptr, .close = nullptr});
  if (made == nullptr) return;
  // Whole lines, so that two threads never share one.
  static_cast<void>(std::setvbuf(made, nullptr, _IOLBF, BUFSIZ));
  std::fflush(stream);
  stream = made;
}

}  // namespace

void mark_for_journal() {
  replace(stdout, g_out);
  replace(stderr, g_error);
}

}  // namespace biteline
