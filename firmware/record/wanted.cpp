// SPDX-License-Identifier: MIT
#include "firmware/record/wanted.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <vector>

#include "firmware/record/room.hpp"

namespace biteline::record {
namespace {

namespace fs = std::filesystem;

/// "scan.wanted": the scan that ends next is.
fs::path wish_of(const fs::path& series) {
  return series.string() + ".wanted";
}

/// Another program may take the free name at the same moment: what it moved there is not replaced.
Result<fs::path> move_into(const fs::path& series, const fs::path& recording) {
  constexpr int k_most_turns = 100;
  fs::path kept;
  int reason = EEXIST;
  for (int turn = 0; reason == EEXIST && turn < k_most_turns; ++turn) {
    kept = free_name(series);
    if (::renameat2(AT_FDCWD, recording.c_str(), AT_FDCWD, kept.c_str(), RENAME_NOREPLACE) == 0) return kept;
    reason = errno;
  }
  // A file system that cannot promise it.
  if (reason == EINVAL && ::rename(recording.c_str(), kept.c_str()) == 0) return kept;
  return fail_errno(Errc::WriteFailed, reason, "%s", kept.c_str());
}

}  // namespace

fs::path waiting_name(const fs::path& series) {
  fs::path name = series;
  const bool file = is_mcap_name(series);
  name.replace_filename((file ? series.stem() : series.filename()).string() + "-last" +
                        (file ? ".mcap" : ""));
  return name;
}

Result<fs::path> keep_last(const fs::path& series) {
  const std::vector<fs::path> waiting = recordings_of(waiting_name(series));
  for (auto newest = waiting.rbegin(); newest != waiting.rend(); ++newest) {
    // Held: being written, or being removed.
    const Result<HeldRecording> ours = HeldRecording::hold(*newest);
    if (ours) return move_into(series, *newest);
  }
  return fail(Errc::FileNotFound, "%s: no scan waits there", waiting_name(series).c_str());
}

Result<void> keep_next(const fs::path& series) {
  const fs::path wish = wish_of(series);
  const int number = ::open(wish.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  const bool full = errno == ENOSPC || errno == EDQUOT;
  if (number < 0) return fail_errno(full ? Errc::DiskFull : Errc::WriteFailed, errno, "%s", wish.c_str());
  ::close(number);
  return {};
}

Result<fs::path> settle_wish(const fs::path& waiting, const fs::path& series) {
  std::error_code error;
  if (!fs::exists(wish_of(series), error)) return waiting;
  BITELINE_ASSIGN(const fs::path kept, move_into(series, waiting));
  // Only now: a wish outlives a recorder that is killed before.
  fs::remove(wish_of(series), error);
  return kept;
}

}  // namespace biteline::record
