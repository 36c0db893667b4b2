// SPDX-License-Identifier: MIT
#pragma once
/// \file What the gates of a line said, told so that a person sees which one failed, by how much, and where.

#include <cstdint>
#include <vector>

#include "host/bite_line/refused.hpp"

namespace biteline::bite_line {

/// One gate of decide()'s table.
struct SeenGate {
  Refused code{};
  const char* measure{""};  ///< what it measures, with its unit at the end: "longest_gap_mm", "upper_share"
  double value{0};
  double limit{0};
  bool at_most{false};  ///< the value may be no larger than the limit; else no smaller
  double sure{0};       ///< 0 to 1: 0.5 at the limit
  bool soft{false};     ///< its no asks for a person
};

/// What a place of a path lacks, as bits.
enum class Lack : std::uint8_t { Surface = 1, Crease = 2, Upper = 4, Sole = 8, Layer = 16 };

/// The bit that a refusal speaks of; 0: of no single place.
[[nodiscard]] constexpr std::uint8_t lack_of(Refused code) {
  switch (code) {
    case Refused::TooMuchMissing:
    case Refused::TooMuchBridged:
      return static_cast<std::uint8_t>(Lack::Surface);
    case Refused::NoCrease:
    case Refused::NoCreaseAllRound:
      return static_cast<std::uint8_t>(Lack::Crease);
    case Refused::NoUpper:
      return static_cast<std::uint8_t>(Lack::Upper);
    case Refused::NoSole:
      return static_cast<std::uint8_t>(Lack::Sole);
    case Refused::Rivalled:
      return static_cast<std::uint8_t>(Lack::Layer);
    default:
      return 0;
  }
}

}  // namespace biteline::bite_line
