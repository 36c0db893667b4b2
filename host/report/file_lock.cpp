// SPDX-License-Identifier: MIT
#include "host/report/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

namespace biteline::report {
namespace {

namespace fs = std::filesystem;

/// Links are not followed: in a folder that all may write to, a link could name any file.
int open_lock(const fs::path& file) {
  constexpr int k_flags = O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK;
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | k_flags, 0644);
  // Whatever the program's umask is, others must be able to see who holds it.
  if (fd >= 0) static_cast<void>(::fchmod(fd, 0644));
  // Another user's file, or one that the kernel protects in a shared folder: its lock serves all the same.
  return fd >= 0 || errno != EACCES ? fd : ::open(file.c_str(), O_RDONLY | k_flags);
}

/// What the holder wrote, one line of printable characters.
std::string holder_of(int fd) {
  std::array<char, 120> text{};
  const ssize_t got = ::pread(fd, text.data(), text.size(), 0);
  std::string line;
  for (ssize_t i = 0; i < got && text[static_cast<std::size_t>(i)] >= ' '; ++i)
    line += text[static_cast<std::size_t>(i)];
  return line.empty() ? "another program" : line;
}

}  // namespace

Result<void> lock_open_file(int fd, const std::string& what) {
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0) return {};
  if (errno == EWOULDBLOCK) return fail(Errc::PeerRefused, "%.200s is held by another program", what.c_str());
  return fail_errno(Errc::WriteFailed, errno, "%.200s", what.c_str());
}

Result<FileLock> FileLock::take(const fs::path& file, const std::string& holder) {
  const int fd = open_lock(file);
  if (fd < 0) return fail_errno(Errc::WriteFailed, errno, "%.200s", file.c_str());
  FileLock lock{fd};
  if (Result<void> locked = lock_open_file(fd, file.string()); !locked) {
    if (locked.error().code != Errc::PeerRefused) return tl::unexpected<Error>{locked.error()};
    return fail(Errc::PeerRefused, "%.120s is held by %.120s", file.c_str(), holder_of(fd).c_str());
  }
  // Only words for whoever comes second: the lock holds without them.
  const std::string line = holder + "\n";
  if (::ftruncate(fd, 0) == 0) static_cast<void>(::pwrite(fd, line.data(), line.size(), 0) < 0);
  return lock;
}

FileLock::FileLock(FileLock&& other) noexcept : fd_{std::exchange(other.fd_, -1)} {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

FileLock::~FileLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace biteline::report
