// SPDX-License-Identifier: MIT
#include "firmware/record/room.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <utility>
#include <vector>

namespace biteline::record {
namespace {

namespace fs = std::filesystem;

struct Recording {
  fs::path folder;
  fs::file_time_type ended;
  std::uint64_t bytes{0};
};

/// "scan", "scan-2", "scan-17": as free_session_folder() names them.
bool is_of(const std::string& series, const std::string& name) {
  if (!name.starts_with(series)) return false;
  const std::string rest = name.substr(series.size());
  return rest.empty() ||
         (rest.size() > 1 && rest[0] == '-' && rest.find_first_not_of("0123456789", 1) == std::string::npos);
}

std::uint64_t bytes_in(const fs::path& folder) {
  std::error_code error;
  std::uint64_t sum = 0;
  for (fs::recursive_directory_iterator entry{folder, error}, end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) sum += entry->file_size(ignored);
  }
  return sum;
}

std::vector<Recording> recordings_of(const fs::path& series) {
  std::vector<Recording> found;
  const fs::path parent = series.has_parent_path() ? series.parent_path() : fs::path{"."};
  const std::string name = series.filename().string();
  std::error_code error;
  for (fs::directory_iterator entry{parent, error}, end; !error && entry != end; entry.increment(error)) {
    std::error_code missing;
    if (entry->is_symlink(missing) || !is_of(name, entry->path().filename().string())) continue;
    const auto ended = fs::last_write_time(entry->path() / "recording.yaml", missing);
    if (missing) continue;
    found.push_back({.folder = entry->path(), .ended = ended, .bytes = bytes_in(entry->path())});
  }
  std::ranges::sort(found, {}, &Recording::ended);
  return found;
}

}  // namespace

Result<HeldFolder> HeldFolder::hold(const fs::path& folder) {
  const int number = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (number < 0) return fail_errno(Errc::FileUnreadable, errno, "%s", folder.c_str());
  HeldFolder held{number};
  if (::flock(number, LOCK_EX | LOCK_NB) != 0) {
    return fail_errno(Errc::WrongState, errno, "%s: somebody writes it", folder.c_str());
  }
  return held;
}

HeldFolder::HeldFolder(HeldFolder&& other) noexcept : number_{std::exchange(other.number_, -1)} {}

HeldFolder& HeldFolder::operator=(HeldFolder&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

HeldFolder::~HeldFolder() {
  if (number_ >= 0) ::close(number_);
}

std::size_t make_room(const fs::path& series, std::uint64_t keep_bytes) {
  const std::vector<Recording> recordings = recordings_of(series);
  std::uint64_t sum = 0;
  for (const Recording& recording : recordings) sum += recording.bytes;
  std::size_t removed = 0;
  for (const Recording& recording : recordings) {
    if (sum <= keep_bytes) break;
    const Result<HeldFolder> ours = HeldFolder::hold(recording.folder);
    if (!ours) continue;
    std::error_code error;
    fs::remove_all(recording.folder, error);
    if (error) continue;
    sum -= recording.bytes;
    ++removed;
  }
  return removed;
}

}  // namespace biteline::record
