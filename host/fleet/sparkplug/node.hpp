// SPDX-License-Identifier: MIT
#pragma once
/// \file A cell as an edge node of Sparkplug B 3.0: topics and payloads, without a network.
///
/// For hosts that speak Sparkplug already.  They see the cell's state now; every shoe, once and in order,
/// comes by the uplink's own topics.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "host/records/memory/memory.hpp"

namespace biteline::fleet::sparkplug {

/// What a host sees of the cell.
struct CellState {
  std::int64_t waiting{0};           ///< shoes that the centre has not committed
  std::optional<memory::Scan> last;  ///< the last shoe; nothing: none yet
};

/// One line to the broker follows another; each has one birth and one death, of the same number (bdSeq).
/// Thread: one owner.
class Node {
 public:
  /// Names as is_cell_name() takes them.  `last_line`: the number of the line before, also of a program that
  /// was killed; 255: none.
  Node(std::string group, std::string cell, std::string version, std::uint8_t last_line = 255);

  /// The next line is about to be opened: its death has the next number.
  void begin_line();
  [[nodiscard]] std::uint8_t line() const { return line_; }
  [[nodiscard]] std::string topic(std::string_view kind) const;  ///< NBIRTH, NDEATH, NDATA, NCMD
  [[nodiscard]] std::string death() const;
  /// All metrics; hosts know nothing before.
  [[nodiscard]] std::string birth(const CellState& state, memory::UnixMs now);
  /// What has changed since the payload before; nothing: all is the same.
  [[nodiscard]] std::optional<std::string> data(const CellState& state, memory::UnixMs now);
  /// A host's command asks for the birth again.  Everything else a command asks for is passed over.
  [[nodiscard]] static bool asks_rebirth(std::string_view payload);

 private:
  /// A time is a number of ms, told as a time.
  struct Time {
    memory::UnixMs ms{0};
    bool operator==(const Time&) const = default;
  };
  using Value = std::variant<std::monostate, std::int64_t, double, bool, std::string, Time>;
  /// The empty value of a metric keeps its type: a host learns types from the birth.
  struct Told {
    std::uint32_t type{0};
    Value value;
    bool operator==(const Told&) const = default;
  };
  using All = std::map<std::string, Told>;

  [[nodiscard]] All metrics_of(const CellState& state) const;
  [[nodiscard]] static std::string payload_of(const All& metrics, memory::UnixMs now,
                                              std::optional<std::uint64_t> seq);
  [[nodiscard]] std::uint64_t next_seq();

  std::string group_, cell_, version_;
  std::uint8_t line_;    ///< bdSeq; 255 is followed by 0
  std::uint8_t seq_{0};  ///< of the next payload
  All told_;
};

}  // namespace biteline::fleet::sparkplug
