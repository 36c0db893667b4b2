// SPDX-License-Identifier: MIT
#include "host/fleet/recording_messages.hpp"

#include <algorithm>
#include <cctype>
#include <limits>

#include "common/core/text.hpp"
#include "host/fleet/fields.hpp"
#include "host/records/release/key_lines.hpp"

namespace biteline::fleet {
namespace {

constexpr std::size_t k_most_words = 300;
constexpr std::size_t k_most_head_bytes = 1000;

/// A column of the centre's.
std::int64_t fetch_number(Fields& fields) {
  const std::int64_t number = fields.whole("number");
  if (number > std::numeric_limits<std::int32_t>::max()) fields.fault("number");
  return number;
}

}  // namespace

bool is_scan_folder(std::string_view name) {
  constexpr std::string_view k_prefix = "scan-";
  if (!name.starts_with(k_prefix)) return false;
  name.remove_prefix(k_prefix.size());
  return name.size() >= 4 && name.size() <= 9 &&
         std::ranges::all_of(name, [](char letter) { return letter >= '0' && letter <= '9'; });
}

bool is_book(std::string_view name) {
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, [](unsigned char letter) {
    return letter < 128 && std::isalnum(letter) != 0;
  });
}

std::string to_text(const FetchAsk& ask) {
  return dump({{"number", ask.number}, {"book", ask.book}, {"scan", ask.scan}, {"at", ask.at}});
}

Result<FetchAsk> read_fetch_ask(std::string_view text) {
  Fields fields{text, "ask for a recording"};
  FetchAsk ask{.number = fetch_number(fields),
               .book = fields.text("book", 64),
               .scan = fields.text("scan", 64),
               .at = fields.whole("at")};
  if (!is_book(ask.book)) fields.fault("book");
  if (!is_scan_folder(ask.scan)) fields.fault("scan");
  BITELINE_TRY(fields.finish());
  return ask;
}

std::string to_payload(const Piece& piece) {
  return dump({{"number", piece.number},
               {"at", piece.at},
               {"total", piece.total},
               {"sha256", piece.sha256},
               {"refused", clean_text(piece.refused, k_most_words)}}) +
         "\n" + piece.bytes;
}

Result<Piece> read_piece(std::string_view payload) {
  const std::size_t end = payload.substr(0, k_most_head_bytes).find('\n');
  if (end == std::string_view::npos || payload.size() - end - 1 > k_piece_bytes)
    return fail(Errc::ProtocolError, "piece of a recording: a line, then at most %zu bytes expected",
                k_piece_bytes);
  Fields fields{payload.substr(0, end), "piece of a recording"};
  Piece piece{.number = fetch_number(fields),
              .at = fields.whole("at"),
              .total = fields.whole("total"),
              .sha256 = fields.text("sha256", 64),
              .refused = fields.text("refused", k_most_words),
              .bytes = std::string{payload.substr(end + 1)}};
  const bool sound = release::is_sha256(piece.sha256) && !piece.bytes.empty() &&
                     static_cast<std::uint64_t>(piece.total) <= k_most_recording_bytes &&
                     piece.at + static_cast<std::int64_t>(piece.bytes.size()) <= piece.total;
  if (piece.refused.empty() && !sound) fields.fault("sha256, total or bytes");
  BITELINE_TRY(fields.finish());
  return piece;
}

}  // namespace biteline::fleet
