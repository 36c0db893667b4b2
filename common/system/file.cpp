// SPDX-License-Identifier: MIT
#include "common/system/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace biteline {
namespace {

Result<void> judge(const struct stat& status, const char* file, std::uint64_t most_bytes) {
  if (!S_ISREG(status.st_mode)) return fail(Errc::FileUnreadable, "%s: a regular file expected", file);
  if (static_cast<std::uint64_t>(status.st_size) > most_bytes) {
    return fail(Errc::BadValue, "%s: at most %llu bytes expected, found %llu", file,
                static_cast<unsigned long long>(most_bytes), static_cast<unsigned long long>(status.st_size));
  }
  return {};
}

tl::unexpected<Error> not_read(const char* file, int reason) {
  return fail_errno(reason == ENOENT || reason == ENOTDIR ? Errc::FileNotFound : Errc::FileUnreadable, reason,
                    "%s", file);
}

class OpenFile {
 public:
  explicit OpenFile(const char* file) : number_{::open(file, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)} {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

}  // namespace

Result<void> check_regular_file(const std::filesystem::path& file, std::uint64_t most_bytes) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return not_read(file.c_str(), errno);
  return judge(status, file.c_str(), most_bytes);
}

Result<std::string> read_regular_file(const std::filesystem::path& file, std::uint64_t most_bytes) {
  BITELINE_TRY(check_regular_file(file, most_bytes));
  const OpenFile opened{file.c_str()};
  struct stat status {};
  if (opened.number() < 0 || ::fstat(opened.number(), &status) != 0) return not_read(file.c_str(), errno);
  // Again: between the two looks another file may have taken the name.
  BITELINE_TRY(judge(status, file.c_str(), most_bytes));
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t size = 0;
  // A file of /proc says 0 bytes and has some: read on until nothing comes, within the bound.
  for (;;) {
    if (size == text.size()) text.resize(size + 4096);
    const ssize_t got = ::read(opened.number(), text.data() + size, text.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return not_read(file.c_str(), errno);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
    if (size > most_bytes) return fail(Errc::BadValue, "%s: it grows while it is read", file.c_str());
  }
  text.resize(size);
  return text;
}

}  // namespace biteline
