// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/served_folder.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <memory>
#include <utility>

namespace biteline::web {
namespace {

struct OpenFile {
  explicit OpenFile(int descriptor) : fd{descriptor} {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (fd >= 0) close(fd);
  }
  int release() { return std::exchange(fd, -1); }
  int fd;
};

int open_beneath(int folder_fd, const std::string& path, std::uint64_t flags) {
  open_how how{};
  how.flags = flags | O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS | RESOLVE_NO_MAGICLINKS;
  return static_cast<int>(syscall(SYS_openat2, folder_fd, path.c_str(), &how, sizeof how));
}

std::int64_t nanoseconds_of(const timespec& time) {
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

tl::unexpected<Error> not_there(const std::string& path) {
  return fail(Errc::FileNotFound, "%.200s", path.c_str());
}

/// Pre: `folder_fd` is a folder; takes it over.
void list_into(int folder_fd, const std::string& prefix, int depth, std::vector<ListedFile>& files) {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder{fdopendir(folder_fd), closedir};
  if (!folder) {
    close(folder_fd);
    return;
  }
  while (const dirent* entry = readdir(folder.get())) {
    const std::string name{entry->d_name};
    if (name.starts_with('.') || files.size() >= k_most_listed_files) continue;
    OpenFile file{open_beneath(dirfd(folder.get()), name, 0)};
    struct stat state {};
    if (file.fd < 0 || fstat(file.fd, &state) != 0) continue;
    if (S_ISREG(state.st_mode)) {
      files.push_back({.path = prefix + name,
                       .size_bytes = static_cast<std::uint64_t>(state.st_size),
                       .changed_ns = nanoseconds_of(state.st_mtim)});
    } else if (S_ISDIR(state.st_mode) && depth < k_most_listed_depth) {
      list_into(file.release(), prefix + name + "/", depth + 1, files);
    }
  }
}

}  // namespace

ServedFile::ServedFile(ServedFile&& other) noexcept
    : fd_{std::exchange(other.fd_, -1)}, size_bytes_{other.size_bytes_}, changed_ns_{other.changed_ns_} {}

ServedFile& ServedFile::operator=(ServedFile&& other) noexcept {
  std::swap(fd_, other.fd_);
  size_bytes_ = other.size_bytes_;
  changed_ns_ = other.changed_ns_;
  return *this;
}

ServedFile::~ServedFile() {
  if (fd_ >= 0) close(fd_);
}

Result<std::size_t> ServedFile::read(std::uint64_t offset, std::string& out) const {
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t got = pread(fd_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail_errno(Errc::FileUnreadable, errno, "pread");
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

Result<ServedFile> open_served_file(const std::filesystem::path& folder, const std::string& path) {
  const OpenFile root{open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (root.fd < 0 || path.empty() || path.find('\0') != std::string::npos) return not_there(path);
  OpenFile file{open_beneath(root.fd, path, 0)};
  struct stat state {};
  if (file.fd < 0 || fstat(file.fd, &state) != 0 || !S_ISREG(state.st_mode)) return not_there(path);
  return ServedFile{file.release(), static_cast<std::uint64_t>(state.st_size), nanoseconds_of(state.st_mtim)};
}

Result<std::vector<ListedFile>> list_served_files(const std::filesystem::path& folder,
                                                  const std::string& path) {
  const OpenFile root{open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (root.fd < 0) return not_there(path);
  OpenFile below{open_beneath(root.fd, path, O_DIRECTORY)};
  if (below.fd < 0) return not_there(path);
  std::vector<ListedFile> files;
  list_into(below.release(), "", 0, files);
  std::ranges::sort(files, {}, &ListedFile::path);
  return files;
}

std::string utc_text(std::int64_t ns_since_1970) {
  const std::time_t seconds = ns_since_1970 / 1'000'000'000;
  std::tm parts{};
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&seconds, &parts));
  return text.data();
}

std::string_view content_type(std::string_view path) {
  struct Kind {
    std::string_view ending;
    std::string_view type;
  };
  static constexpr std::array k_kinds{
      Kind{".html", "text/html; charset=utf-8"},
      Kind{".css", "text/css; charset=utf-8"},
      Kind{".js", "text/javascript; charset=utf-8"},
      Kind{".mjs", "text/javascript; charset=utf-8"},
      Kind{".json", "application/json"},
      Kind{".map", "application/json"},
      Kind{".webmanifest", "application/manifest+json"},
      Kind{".csv", "text/csv; charset=utf-8"},
      Kind{".yaml", "application/yaml"},
      Kind{".txt", "text/plain; charset=utf-8"},
      Kind{".script", "text/plain; charset=utf-8"},
      Kind{".png", "image/png"},
      Kind{".jpg", "image/jpeg"},
      Kind{".svg", "image/svg+xml"},
      Kind{".ico", "image/x-icon"},
      Kind{".woff2", "font/woff2"},
      Kind{".tar", "application/x-tar"},
  };
  for (const Kind& kind : k_kinds) {
    if (path.ends_with(kind.ending)) return kind.type;
  }
  return "application/octet-stream";
}

}  // namespace biteline::web
