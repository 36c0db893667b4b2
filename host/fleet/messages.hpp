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
};
/// As the service wrote it beside the programs' versions.
[[nodiscard]] std::string release_of(const memory::Scan& scan);
[[nodiscard]] std::string to_text(const ShoeMessage& shoe);
/// Errc::ProtocolError names the field; also for numbers that are not finite and texts beyond their bounds.
[[nodiscard]] Result<ShoeMessage> read_shoe(std::string_view text);

/// A cell's word that it lives; the broker says `online` false in its place when its line is cut.
struct HealthMessage {
  bool online{false};
  std::string version;
  std::string book;
  std::int64_t waiting{0};  ///< shoes that the centre has not committed
};
[[nodiscard]] std::string to_text(const HealthMessage& health);
[[nodiscard]] Result<HealthMessage> read_health(std::string_view text);

/// Up to here the centre has committed.
struct CommittedMessage {
  std::string book;
  std::int64_t seq{0};
};
[[nodiscard]] std::string to_text(const CommittedMessage& committed);
[[nodiscard]] Result<CommittedMessage> read_committed(std::string_view text);

}  // namespace biteline::fleet
