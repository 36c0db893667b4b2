// SPDX-License-Identifier: MIT
#pragma once
/// \file What goes wrong again and again: told at once, then after 2, 4, 8 ... s, at last each minute.

#include <map>
#include <string>

#include "common/time/clocks.hpp"

namespace biteline::service {

/// A log that says the same each second hides what it says else.  Words are the same where they differ in
/// figures alone: "0 of 815 profiles", "0 of 817 profiles".  Other words are told at once; words that take
/// turns each have their own wait.  Thread: one at a time; the owner locks.
class ToldOnce {
 public:
  struct Heard {
    bool tells{false};
    int untold{0};       ///< how often it was heard, and not told, since it was told last
    Nanoseconds wait{};  ///< until it may be told again; who tries again waits so long, too
  };
  /// It goes wrong now; by the same clock each time.
  [[nodiscard]] Heard hear(const std::string& words, HostClock::time_point now);
  /// It went well: whatever comes next is new.
  void mended() { known_.clear(); }

 private:
  struct Known {
    HostClock::time_point told{}, heard{};
    Nanoseconds wait{};
    int untold{0};
  };
  void forget_old(HostClock::time_point now);

  std::map<std::string, Known> known_;
};

/// The words, and how often they would have been told meanwhile.
[[nodiscard]] std::string with_count(const std::string& words, const ToldOnce::Heard& heard);

}  // namespace biteline::service
