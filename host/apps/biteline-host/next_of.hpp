// SPDX-License-Identifier: MIT
#pragma once
/// \file What becomes of a scan that has a line: it goes to the arm, waits for a person, is refused, or is
/// kept.

#include <cstdint>
#include <string>

namespace biteline::service {

enum class Next : std::uint8_t {
  Send,    ///< to the gate, which judges it
  Hold,    ///< until a person says a word
  Refuse,  ///< a person would have to look, and none can
  Keep     ///< its files are all that was asked for, or all there is
};

struct NextFacts {
  bool sends{false};          ///< paths go to an arm
  bool has_path{false};       ///< every check of it passed
  bool doors{false};          ///< somebody can be asked
  bool waits{false};          ///< it waits also without a path: for review, or taught
  bool confirmed{false};      ///< a person has said yes to this scan at the start
  bool seen{false};           ///< it came in live and whole: the gate does not ask for such a yes
  bool asks_by_gate{false};   ///< the process wants a person's yes
  bool asked_to_hold{false};  ///< a person wants to see it first
  bool drift_stops{false};    ///< the calibration has drifted, and that stops
  std::string looks{};        ///< why a person has to look though nobody asked for it; empty: no reason
};

struct NextStep {
  Next next{Next::Keep};
  bool keeps_recording{false};  ///< a person may still say yes
  std::string why{};            ///< of Refuse
  bool operator==(const NextStep&) const = default;
};

/// The first row that fits:
///
/// | facts | next |
/// | --- | --- |
/// | no paths are sent | Keep |
/// | waits in any case | Hold |
/// | no path | Keep |
/// | confirmed | Send |
/// | somebody or something asks for a person, doors | Hold |
/// | drifted, or has to be looked at, or is to be held; no doors | Refuse |
/// | else, also where the gate will ask for a yes that nobody can say | Send |
[[nodiscard]] NextStep next_of(const NextFacts& facts);

}  // namespace biteline::service
