// SPDX-License-Identifier: MIT
#include "host/fleet/recording_giver.hpp"

#include <chrono>

namespace biteline::fleet {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t k_hash_at_once = 4U << 20U;
constexpr std::chrono::minutes k_left_lying{10};

}  // namespace

void RecordingGiver::hear(const FetchAsk& ask) {
  // From the begin again: what was given did not fit together, so its folder is looked at anew.
  if (ask.at == 0 && given_) stream_.reset();
  ask_ = ask;
  left_ = k_pieces_an_ask;
}

std::optional<Piece> RecordingGiver::step(const std::string& book) {
  if (!ask_ || book.empty()) return std::nullopt;
  if (ask_->book != book) return refuse("the cell has begun a new memory since; its folder is another one");
  if (scan_ != ask_->scan || !stream_) {
    Result<archive::TarStream> stream =
        archive::TarStream::open(results_ / ask_->scan, k_most_recording_bytes);
    if (!stream && stream.error().code == Errc::FileNotFound)
      return refuse(ask_->scan + " is gone: the cell has removed its folder");
    if (!stream) return refuse(to_line(stream.error()));
    scan_ = ask_->scan;
    stream_ = std::move(*stream);
    digest_.emplace();
    hashed_ = 0;
    sha256_.clear();
    given_ = false;
  }
  if (sha256_.empty()) {
    if (const Result<void> hashed = hash_some(); !hashed) return refuse(to_line(hashed.error()));
    return std::nullopt;
  }
  const auto total = static_cast<std::int64_t>(stream_->bytes());
  // The folder has become smaller since a predecessor gave the bytes before these.  The centre sees another
  // SHA-256 and begins anew.
  if (ask_->at >= total) ask_->at = 0;
  Result<std::string> bytes = stream_->read(static_cast<std::uint64_t>(ask_->at), k_piece_bytes);
  if (!bytes) return refuse(to_line(bytes.error()));
  Piece piece{.number = ask_->number,
              .at = ask_->at,
              .total = total,
              .sha256 = sha256_,
              .refused = {},
              .bytes = std::move(*bytes)};
  given_ = true;
  ask_->at += static_cast<std::int64_t>(piece.bytes.size());
  if (--left_ == 0 || ask_->at >= total) ask_.reset();
  return piece;
}

Result<void> RecordingGiver::hash_some() {
  BITELINE_ASSIGN(const std::string bytes, stream_->read(hashed_, k_hash_at_once));
  digest_->add(bytes);
  hashed_ += bytes.size();
  if (hashed_ < stream_->bytes()) return {};
  sha256_ = digest_->hex();
  digest_.reset();
  return {};
}

Piece RecordingGiver::refuse(const std::string& why) {
  Piece piece{.number = ask_->number, .at = 0, .total = 0, .sha256 = {}, .refused = why, .bytes = {}};
  ask_.reset();
  // What was read of it may be of a folder that has changed.
  stream_.reset();
  return piece;
}

bool cell_works(const fs::path& results) {
  std::string newest;
  std::error_code error;
  for (fs::directory_iterator at{results, error}, end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    // A longer number is a higher one.
    const bool later = name.size() != newest.size() ? name.size() > newest.size() : name > newest;
    if (is_scan_folder(name) && later) newest = name;
  }
  if (newest.empty() || fs::exists(results / newest / "report.json", error)) return false;
  const auto changed = fs::last_write_time(results / newest, error);
  return !error && fs::file_time_type::clock::now() - changed < k_left_lying;
}

}  // namespace biteline::fleet
