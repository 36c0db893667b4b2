// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/recording_talk.hpp"

#include <algorithm>

namespace biteline::fleet {
namespace {

constexpr std::chrono::milliseconds k_between_reads{1000};
constexpr std::chrono::seconds k_between_tidies{10};
/// More than so many are dropped: they are asked for again.
constexpr std::size_t k_most_pieces = 200;

bool ended(const FetchRow& row) {
  return row.state == FetchState::Whole || row.state == FetchState::Refused;
}

}  // namespace

RecordingTalk::RecordingTalk(const std::filesystem::path& folder, const RecordingLimits& limits)
    : limits_{limits} {
  if (!folder.empty()) taker_.emplace(folder);
}

Result<bool> RecordingTalk::hear(std::string_view topic, std::string_view payload) {
  const std::optional<std::string> cell = cell_of(topic, "recording");
  if (!cell) return false;
  BITELINE_ASSIGN(Piece piece, read_piece(payload));
  if (taker_ && pieces_.size() < k_most_pieces) pieces_.emplace_back(*cell, std::move(piece));
  return true;
}

Result<void> RecordingTalk::work(Centre& centre, const Publish& publish, Clock::time_point now) {
  Recordings recordings{centre};
  if (taker_) {
    for (const auto& [cell, piece] : pieces_) {
      if (const std::optional<FetchRow> row = taker_->hear(cell, piece, now)) changed_[row->number] = *row;
    }
    pieces_.clear();
    for (const FetchRow& row : taker_->work(now)) changed_[row.number] = row;
  }
  const bool any_ended = std::ranges::any_of(changed_, [](const auto& one) { return ended(one.second); });
  if (any_ended || now >= read_at_) {
    for (const auto& [number, row] : changed_) BITELINE_TRY(recordings.note(row));
    changed_.clear();
    BITELINE_TRY(read_open(recordings, now));
  }
  if (taker_ && limits_.any() && now >= tidy_at_) {
    tidy_at_ = now + k_between_tidies;
    BITELINE_TRY(recordings.tidy(limits_, [this](const FetchRow& row) { return taker_->file_of(row); }));
  }
  for (const FetchRow& row : open_) {
    const std::optional<FetchAsk> ask = taker_ ? taker_->look(row, now) : std::nullopt;
    if (ask) publish(topic_of(row.cell, "fetch"), to_text(*ask));
  }
  return {};
}

Result<void> RecordingTalk::read_open(Recordings& recordings, Clock::time_point now) {
  read_at_ = now + k_between_reads;
  BITELINE_ASSIGN(open_, recordings.open());
  if (taker_) return {};
  for (FetchRow& row : open_) {
    row.state = FetchState::Refused;
    row.words = "this centre keeps no recordings; start it with --recordings DIR";
    BITELINE_TRY(recordings.note(row));
  }
  open_.clear();
  return {};
}

}  // namespace biteline::fleet
