// SPDX-License-Identifier: MIT
#include "host/fleet/part_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace biteline::fleet {
namespace {

namespace fs = std::filesystem;

struct Fd {
  Fd(const fs::path& file, int flags) : fd{::open(file.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, 0600)} {}
  Fd(const Fd&) = delete;
  Fd& operator=(const Fd&) = delete;
  ~Fd() {
    if (fd >= 0) ::close(fd);
  }
  int fd;
};

Result<void> failed_write(const fs::path& file, int write_errno) {
  return fail_errno(write_errno == ENOSPC ? Errc::DiskFull : Errc::WriteFailed, write_errno, "%.200s",
                    file.c_str());
}

}  // namespace

std::int64_t part_bytes(const fs::path& file) {
  std::error_code error;
  const auto bytes = fs::file_size(file, error);
  return error ? 0 : static_cast<std::int64_t>(bytes);
}

Result<void> write_part(const fs::path& file, std::int64_t at, std::string_view bytes) {
  const Fd out{file, O_WRONLY | O_CREAT};
  if (out.fd < 0) return failed_write(file, errno);
  if (part_bytes(file) < at) return fail(Errc::SizeMismatch, "%.200s has become shorter", file.c_str());
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t now = ::pwrite(out.fd, bytes.data() + done, bytes.size() - done,
                                 static_cast<off_t>(at) + static_cast<off_t>(done));
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) return failed_write(file, errno);
    done += static_cast<std::size_t>(now);
  }
  if (::ftruncate(out.fd, static_cast<off_t>(at) + static_cast<off_t>(bytes.size())) != 0)
    return failed_write(file, errno);
  return {};
}

Result<std::string> read_part_bytes(const fs::path& file, std::int64_t at, std::size_t most) {
  const Fd in{file, O_RDONLY};
  if (in.fd < 0) return fail_errno(Errc::FileNotFound, errno, "%.200s", file.c_str());
  std::string bytes(most, '\0');
  std::size_t done = 0;
  while (done < most) {
    const ssize_t now =
        ::pread(in.fd, bytes.data() + done, most - done, static_cast<off_t>(at) + static_cast<off_t>(done));
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) return fail_errno(Errc::FileUnreadable, errno, "%.200s", file.c_str());
    if (now == 0) break;
    done += static_cast<std::size_t>(now);
  }
  bytes.resize(done);
  return bytes;
}

Result<void> finish_part(const fs::path& file, std::int64_t bytes, const fs::path& whole) {
  if (part_bytes(file) != bytes)
    return fail(Errc::SizeMismatch, "%.200s: %lld bytes expected", file.c_str(),
                static_cast<long long>(bytes));
  {
    const Fd out{file, O_WRONLY};
    if (out.fd < 0 || ::fsync(out.fd) != 0) return failed_write(file, errno);
  }
  if (::rename(file.c_str(), whole.c_str()) != 0) return failed_write(whole, errno);
  const Fd folder{whole.parent_path(), O_RDONLY | O_DIRECTORY};
  if (folder.fd < 0 || ::fsync(folder.fd) != 0) return failed_write(whole, errno);
  return {};
}

}  // namespace biteline::fleet
