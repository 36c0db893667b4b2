// SPDX-License-Identifier: MIT
#include "firmware/record/room.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "firmware/record/record_store.hpp"

namespace biteline::record {
namespace {

namespace fs = std::filesystem;

/// A file's library (mcap::Header) stands behind its first bytes.
constexpr std::size_t k_head_bytes = 64;

std::string stem_of(const fs::path& recording) {
  return (is_mcap_name(recording) ? recording.stem() : recording.filename()).string();
}

struct Recording {
  fs::path path;
  fs::file_time_type ended;
  std::uint64_t bytes{0};
};

/// "scan", "scan-2", "scan-17", and "scan.mcap", "scan-2.mcap": as free_name() names them.
bool is_of(const fs::path& series, const fs::path& name) {
  if (is_mcap_name(series) != is_mcap_name(name)) return false;
  const std::string first = stem_of(series), other = stem_of(name);
  if (!other.starts_with(first)) return false;
  const std::string rest = other.substr(first.size());
  return rest.empty() ||
         (rest.size() > 1 && rest[0] == '-' && rest.find_first_not_of("0123456789", 1) == std::string::npos);
}

std::uint64_t bytes_in(const fs::path& recording) {
  std::error_code error;
  if (fs::is_regular_file(recording, error)) return fs::file_size(recording, error);
  std::uint64_t sum = 0;
  for (fs::recursive_directory_iterator entry{recording, error}, end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) sum += entry->file_size(ignored);
  }
  return sum;
}

/// What a foreign file or folder is not: one that this program wrote.
bool is_ours(const fs::path& recording) {
  std::error_code error;
  if (!is_mcap_name(recording)) return fs::exists(recording / "recording.yaml", error);
  if (!fs::is_regular_file(recording, error)) return false;
  std::ifstream in{recording, std::ios::binary};
  std::string head(k_head_bytes, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return head.find(k_recorder) != std::string::npos;
}

std::vector<Recording> found_of(const fs::path& series) {
  std::vector<Recording> found;
  const fs::path parent = series.has_parent_path() ? series.parent_path() : fs::path{"."};
  std::error_code error;
  for (fs::directory_iterator entry{parent, error}, end; !error && entry != end; entry.increment(error)) {
    std::error_code missing;
    const fs::path& path = entry->path();
    if (entry->is_symlink(missing) || !is_of(series, path.filename()) || !is_ours(path)) continue;
    const auto ended = fs::last_write_time(is_mcap_name(path) ? path : path / "recording.yaml", missing);
    if (missing) continue;
    found.push_back({.path = path, .ended = ended, .bytes = bytes_in(path)});
  }
  std::ranges::sort(found, {}, &Recording::ended);
  return found;
}

}  // namespace

Result<HeldRecording> HeldRecording::hold(const fs::path& recording) {
  const int number = ::open(recording.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (number < 0) return fail_errno(Errc::FileUnreadable, errno, "%s", recording.c_str());
  HeldRecording held{number};
  if (::flock(number, LOCK_EX | LOCK_NB) != 0) {
    return fail_errno(Errc::WrongState, errno, "%s: somebody writes it", recording.c_str());
  }
  return held;
}

HeldRecording::HeldRecording(HeldRecording&& other) noexcept : number_{std::exchange(other.number_, -1)} {}

HeldRecording& HeldRecording::operator=(HeldRecording&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

HeldRecording::~HeldRecording() {
  if (number_ >= 0) ::close(number_);
}

bool is_mcap_name(const fs::path& recording) {
  return recording.extension() == ".mcap";
}

fs::path free_name(const fs::path& wanted) {
  std::error_code ignored;
  fs::path name = wanted;
  for (int number = 2; fs::exists(name, ignored); ++number) {
    name = wanted;
    name.replace_filename(stem_of(wanted) + "-" + std::to_string(number) +
                          (is_mcap_name(wanted) ? ".mcap" : ""));
  }
  return name;
}

std::vector<fs::path> recordings_of(const fs::path& series) {
  std::vector<fs::path> paths;
  for (Recording& recording : found_of(series)) paths.push_back(std::move(recording.path));
  return paths;
}

std::size_t make_room(const fs::path& series, std::uint64_t keep_bytes) {
  const std::vector<Recording> recordings = found_of(series);
  std::uint64_t sum = 0;
  for (const Recording& recording : recordings) sum += recording.bytes;
  std::size_t removed = 0;
  for (const Recording& recording : recordings) {
    if (sum <= keep_bytes) break;
    const Result<HeldRecording> ours = HeldRecording::hold(recording.path);
    if (!ours) continue;
    std::error_code error;
    fs::remove_all(recording.path, error);
    if (error) continue;
    sum -= recording.bytes;
    ++removed;
  }
  return removed;
}

}  // namespace biteline::record
