// SPDX-License-Identifier: MIT
#pragma once
/// \file The centre's side of releases: offered, had by each cell, switched at one time.

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "host/fleet/centre.hpp"
#include "host/fleet/release_messages.hpp"
#include "host/records/release/order.hpp"

namespace biteline::fleet {

/// A cell of a release as it stands.
struct ReleaseCell {
  std::string cell;
  bool ready{false};  ///< has it whole and checked, is heard, and its clock is right
  bool in_force{false};
  std::string why;  ///< not ready
};
struct ReleaseRow {
  std::int64_t number{0};
  std::string name, sha256;
  std::int64_t bytes{0};
  std::vector<ReleaseCell> cells;
};

enum class SwitchState { Planned, Sure, Withdrawn };
struct SwitchRow {
  SwitchState state{SwitchState::Planned};
  std::int64_t at_ms{0};
  std::vector<std::string> silent;  ///< cells that do not know it, with what is wrong there; of a withdrawn
                                    ///< one: when it was withdrawn
};

/// How long before its time a switch is sure or withdrawn, and the earliest time of a switch, in s.
inline constexpr int k_decided_before_s = 3;
inline constexpr int k_least_ahead_s = 10;
/// The latest one.
inline constexpr int k_most_ahead_s = 24 * 3600;
/// An order's number is at most so much larger than the newest one known here; nor is a cell's word believed
/// beyond it.  Orders with ever larger numbers would come to an end.
inline constexpr std::int64_t k_most_step = 1000;

/// In the centre's database; Errc as there.  Thread: the centre's owner.
class Releases {
 public:
  explicit Releases(Centre& centre) : centre_{centre} {}

  /// The file, its manifest and signature beside it; to these cells.  One that was offered before is offered
  /// anew, for these.  Returns its number.
  [[nodiscard]] Result<std::int64_t> offer(const std::filesystem::path& file,
                                           const std::vector<std::string>& cells);
  /// Out of the database, with its switches.  Errc::WrongState names the cells where it is in force, or the
  /// switch to it that is still to come; Errc::InvalidArgument: there is none of this number.
  [[nodiscard]] Result<void> forget(std::int64_t release);
  /// Newest offer first.
  [[nodiscard]] Result<std::vector<ReleaseRow>> list();
  /// What is to be signed: all cells of the release, so many seconds from now, with the next free number.
  /// `after`: the newest one that a person knows of; 0: none but what is known here.
  [[nodiscard]] Result<release::Order> order_of(std::int64_t release, int in_s, std::int64_t after = 0);
  /// The text of an order and its signature, which the cells check.  Errc::WrongState names who is not ready,
  /// the switch that is still open or newer, or that the order's time is too near or its number too large.
  /// Returns the switch's number.
  [[nodiscard]] Result<std::int64_t> plan_switch(const std::string& order, const std::string& signature,
                                                 std::int64_t after = 0);
  [[nodiscard]] Result<SwitchRow> switch_row(std::int64_t number);
  /// Makes a planned switch sure where all know of it; withdraws it where its time is too near, and at once
  /// where one of its cells does not follow it.  Returns the cells that are to be told now.
  [[nodiscard]] Result<std::vector<std::string>> decide();

  [[nodiscard]] Result<void> note(const std::string& cell, const ReleaseWord& word);
  /// What is to be told to this cell.
  [[nodiscard]] Result<ReleasePlan> plan_of(const std::string& cell);
  /// The parts of a release from a byte on, at most k_parts_at_once.
  [[nodiscard]] Result<std::vector<Part>> parts(const PartAsk& ask);

 private:
  Centre& centre_;
};

}  // namespace biteline::fleet
