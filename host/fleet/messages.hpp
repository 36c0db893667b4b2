// SPDX-License-Identifier: MIT
#pragma once
/// \file What goes between cells and centre over the broker: topics, and one JSON text each.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::fleet {

/// Letters, digits, '-' and '_', at most 64: it stands in topics and in the cell's certificate.
[[nodiscard]] bool is_cell_name(std::string_view name);
/// The centre's own name at the broker, and a Sparkplug host's: no cell's.
[[nodiscard]] bool is_reserved_name(std::string_view name);

inline constexpr const char* k_all_shoes = "biteline/1/cells/+/shoes";
inline constexpr const char* k_all_health = "biteline/1/cells/+/health";
[[nodiscard]] std::string shoes_topic(const std::string& cell);      ///< cell to centre
[[nodiscard]] std::string health_topic(const std::string& cell);     ///< cell to centre, kept by the broker
[[nodiscard]] std::string committed_topic(const std::string& cell);  ///< centre to cell
[[nodiscard]] std::string topic_of(const std::string& cell, const char* kind);
/// The cell of a topic that ends in `kind` ("shoes", "health"); nothing: another topic.
[[nodiscard]] std::optional<std::string> cell_of(std::string_view topic, std::string_view kind);

/// One shoe of a cell's memory.  `after` is the row before it, so that none can be missing.
struct ShoeMessage {
  std::string book;  ///< of the memory's file
  std::int64_t seq{0};
  std::int64_t after{0};
  memory::Scan scan;
  std::optional<memory::Places> places{};
  std::string release{};  ///< SHA-256 of the release that it was worked with; empty: the cell's own files
  /// At the centre: what of it could not be read; the rest stands, and the row goes on as a dead letter.
  std::string fault{};
};
/// As the service wrote it beside the programs' versions.
[[nodiscard]] std::string release_of(const memory::Scan& scan);
/// Texts are cleaned and cut to their bounds with "...", numbers that are none are left out: whatever a
/// memory holds, the centre can read it.
[[nodiscard]] std::string to_text(const ShoeMessage& shoe);
/// No more of it than what places the row, and why: for one that is not taken as it is.
[[nodiscard]] ShoeMessage bare_of(const ShoeMessage& shoe, const std::string& why);
/// Errc::ProtocolError: it cannot be placed, for book, seq or after are missing.  What else is wrong stands
/// in `fault`.
[[nodiscard]] Result<ShoeMessage> read_shoe(std::string_view text);
/// A row as it goes over the broker.
[[nodiscard]] memory::Scan fitted(const memory::Scan& scan, std::int64_t seq);

/// A cell's word that it lives; the broker says `online` false in its place when its line is cut.
struct HealthMessage {
  bool online{false};
  std::string version;
  std::string book;
  std::int64_t waiting{0};  ///< shoes that the centre has not committed
  /// Newest of the cell's log, which the centre keeps: so a cut end is found.  Row 0: none is known.
  memory::LogLink log{};
};
[[nodiscard]] std::string to_text(const HealthMessage& health);
[[nodiscard]] Result<HealthMessage> read_health(std::string_view text);

/// A row that the centre could not read, and took without what was wrong.
struct DeadLetter {
  std::int64_t seq{0};
  std::string scan;
  std::string why;
  bool operator==(const DeadLetter&) const = default;
};
inline constexpr std::size_t k_most_letters_told = 20;

/// Up to here the centre has committed.
struct CommittedMessage {
  std::string book;
  std::int64_t seq{0};
  std::int64_t dead{0};               ///< rows of this book that were taken as dead letters
  std::vector<DeadLetter> letters{};  ///< the newest of them, oldest first
  std::string held{};                 ///< why rows are taken later; empty: they are not
};
[[nodiscard]] std::string to_text(const CommittedMessage& committed);
[[nodiscard]] Result<CommittedMessage> read_committed(std::string_view text);

}  // namespace biteline::fleet
