// SPDX-License-Identifier: MIT
#pragma once
/// \file The faults of a soak, of both tables (tests/integration/faults), and what may become of a scan then.

#include <chrono>
#include <functional>
#include <span>
#include <string>

#include "tests/soak/stand.hpp"

namespace biteline::soak {

/// How a scan's account can close.
enum class Outcome : unsigned {
  Followed,   ///< a result: the arm followed the whole path
  Refused,    ///< a reason instead of a line
  NoPath,     ///< a line, and a reason instead of a path
  NotSent,    ///< a path, and the gate's reason against sending it
  Halted,     ///< the arm was stopped on its way, for a reason
  Abandoned,  ///< sent, and the service died before it could write what became of it
  Open,       ///< no account: never right
};
constexpr std::size_t k_outcomes = 7;
[[nodiscard]] const char* name_of(Outcome outcome);

/// A set of outcomes.
[[nodiscard]] constexpr unsigned any_of(std::initializer_list<Outcome> outcomes) {
  unsigned set = 0;
  for (const Outcome outcome : outcomes) set |= 1U << static_cast<unsigned>(outcome);
  return set;
}
[[nodiscard]] constexpr bool contains(unsigned set, Outcome outcome) {
  return (set & (1U << static_cast<unsigned>(outcome))) != 0;
}

struct Fault {
  /// On the line: while the tool works; on the way to it the host looks at the joints.
  enum class When { Never, Scan, Follow, OnLine };
  /// Repairs when it goes: a hanging thread runs on, a door closes.
  using Undo = std::shared_ptr<void>;

  const char* name;
  When when;
  std::chrono::milliseconds lasts;
  bool darkens;        ///< the laser's line must fall within 100 ms
  unsigned outcomes;   ///< that are right
  const char* reason;  ///< a part of its reason code or reason where it was refused or halted; "": any
  std::function<Undo(Stand&)> make;
  std::chrono::milliseconds noticed{0};  ///< of one that halts the arm: the limit that it must pass
};

/// The first one is none.
[[nodiscard]] std::span<const Fault> fault_table();

}  // namespace biteline::soak
