// SPDX-License-Identifier: MIT
#include "host/fleet/recording_taker.hpp"

#include <algorithm>

#include "host/fleet/part_file.hpp"

namespace biteline::fleet {
namespace {

namespace fs = std::filesystem;

/// A piece that does not come is asked for again.
constexpr std::chrono::seconds k_taker_patience{3};
constexpr std::size_t k_taker_hash_at_once = 4U << 20U;
/// Left free on the centre's disk.
constexpr std::uint64_t k_spare_bytes = 1ULL << 30U;

}  // namespace

fs::path RecordingTaker::file_of(const FetchRow& row) const {
  return folder_ / row.cell / row.book / (row.scan + ".tar");
}

fs::path RecordingTaker::part_of(const FetchRow& row) const {
  return file_of(row).string() + ".part";
}

bool RecordingTaker::busy() const {
  return std::ranges::any_of(coming_, [](const auto& one) { return one.second.digest.has_value(); });
}

std::optional<FetchAsk> RecordingTaker::look(const FetchRow& row, Clock::time_point now) {
  auto found = coming_.find(row.number);
  // Of a database that was put back: the same number for another scan.
  if (found != coming_.end() && file_of(found->second.row) != file_of(row)) {
    coming_.erase(found);
    found = coming_.end();
  }
  if (found == coming_.end()) {
    found = coming_.emplace(row.number, Coming{.row = row}).first;
    // Killed between the whole file's name and the database's word of it: it is checked once more.
    std::error_code ignored;
    if (row.total > 0 && !fs::exists(part_of(row), ignored) && part_bytes(file_of(row)) == row.total)
      fs::rename(file_of(row), part_of(row), ignored);
    // Goes on behind what a predecessor has written.
    found->second.row.have = row.total > 0 ? std::min(part_bytes(part_of(row)), row.total) : 0;
    if (row.total > 0 && found->second.row.have == row.total) found->second.digest.emplace();
  }
  Coming& coming = found->second;
  coming.row.online = row.online;
  if (!row.online || coming.digest) return std::nullopt;
  if (coming.left > 0 && now - coming.asked < k_taker_patience) return std::nullopt;
  coming.left = k_pieces_an_ask;
  coming.asked = now;
  return FetchAsk{.number = row.number, .book = row.book, .scan = row.scan, .at = coming.row.have};
}

std::optional<FetchRow> RecordingTaker::hear(const std::string& cell, const Piece& piece,
                                             Clock::time_point now) {
  const auto found = coming_.find(piece.number);
  if (found == coming_.end() || found->second.row.cell != cell || found->second.digest) return std::nullopt;
  Coming& coming = found->second;
  if (!piece.refused.empty()) return end(piece.number, FetchState::Refused, piece.refused);
  FetchRow& row = coming.row;
  if (piece.sha256 != row.sha256 || piece.total != row.total) {
    // The folder has changed since the first byte: what is here does not belong to the rest.
    if (row.total > 0 && ++row.tries >= k_most_fetch_tries)
      return end(piece.number, FetchState::Refused, "its folder changes while it is read");
    row.sha256 = piece.sha256;
    row.total = piece.total;
    row.have = 0;
  }
  if (piece.at != row.have) {
    // The rest of an older ask.
    coming.left = std::max(0, coming.left - 1);
    return std::nullopt;
  }
  if (const Result<void> taken = take(coming, piece); !taken)
    return end(piece.number, FetchState::Refused, to_line(taken.error()));
  coming.asked = now;
  --coming.left;
  row.state = FetchState::Coming;
  if (row.have == row.total) {
    coming.digest.emplace();
    coming.hashed = 0;
  }
  return row;
}

Result<void> RecordingTaker::take(Coming& coming, const Piece& piece) {
  FetchRow& row = coming.row;
  const fs::path part = part_of(row);
  if (piece.at == 0) {
    std::error_code error;
    fs::create_directories(part.parent_path(), error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", part.parent_path().c_str());
    const fs::space_info space = fs::space(part.parent_path(), error);
    if (!error && space.available < static_cast<std::uint64_t>(row.total) + k_spare_bytes)
      return fail(Errc::DiskFull, "the centre's disk has no room for %lld bytes",
                  static_cast<long long>(row.total));
  }
  BITELINE_TRY(write_part(part, piece.at, piece.bytes));
  row.have += static_cast<std::int64_t>(piece.bytes.size());
  return {};
}

std::vector<FetchRow> RecordingTaker::work(Clock::time_point now) {
  std::vector<FetchRow> changed;
  std::vector<std::int64_t> numbers;
  for (const auto& [number, coming] : coming_) {
    if (coming.digest) numbers.push_back(number);
  }
  for (const std::int64_t number : numbers) {
    Coming& coming = coming_.at(number);
    FetchRow& row = coming.row;
    const Result<bool> sound = check_some(coming);
    if (!sound) {
      changed.push_back(end(number, FetchState::Refused, to_line(sound.error())));
    } else if (coming.hashed < row.total) {
      continue;
    } else if (*sound) {
      changed.push_back(end(number, FetchState::Whole, file_of(row).string()));
    } else if (++row.tries >= k_most_fetch_tries) {
      changed.push_back(end(number, FetchState::Refused, "what came does not have its SHA-256"));
    } else {
      coming.digest.reset();
      coming.left = 0;
      coming.asked = now;
      row.have = 0;
      changed.push_back(row);
    }
  }
  return changed;
}

Result<bool> RecordingTaker::check_some(Coming& coming) {
  const fs::path part = part_of(coming.row);
  BITELINE_ASSIGN(const std::string bytes, read_part_bytes(part, coming.hashed, k_taker_hash_at_once));
  coming.digest->add(bytes);
  coming.hashed += static_cast<std::int64_t>(bytes.size());
  if (bytes.empty()) return fail(Errc::SizeMismatch, "%.200s has become shorter", part.c_str());
  if (coming.hashed < coming.row.total) return false;
  if (coming.digest->hex() != coming.row.sha256) return false;
  BITELINE_TRY(finish_part(part, coming.row.total, file_of(coming.row)));
  return true;
}

FetchRow RecordingTaker::end(std::int64_t number, FetchState state, const std::string& words) {
  FetchRow row = coming_.at(number).row;
  coming_.erase(number);
  row.state = state;
  row.words = words;
  if (state == FetchState::Refused) {
    std::error_code ignored;
    fs::remove(part_of(row), ignored);
  }
  return row;
}

}  // namespace biteline::fleet
