// SPDX-License-Identifier: MIT
#pragma once
/// \file Who has a place in the table of connections, and who gives his to a newcomer when it is full.

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace biteline::web {

/// Thread: one owner.
class Places {
 public:
  using Id = std::uint64_t;
  enum class Standing {
    Silent,    ///< has not said a whole request yet
    Stranger,  ///< has, but without a session that the service knows
    Known,     ///< with one: gives way to nobody
  };
  struct Taken {
    Id id{0};
    std::optional<Id> gives_way{};  ///< this one has lost its place: it is to be ended
  };

  /// `kept`: beyond `all`, for this machine's own.
  Places(int all, int an_address, int kept) : all_{all}, an_address_{an_address}, kept_{kept} {}

  /// Where there is no place, the address that has the most gives one up: first of those who are silent, then
  /// of strangers, the oldest first.  Nothing: all are known.
  [[nodiscard]] std::optional<Taken> take(const std::string& address, bool local);
  /// One that has lost its place stays without.
  void stand(Id id, Standing standing);
  void leave(Id id);
  [[nodiscard]] int count() const { return static_cast<int>(held_.size()); }

 private:
  struct Held {
    std::string address;
    Standing standing{Standing::Silent};
  };
  /// Of one address; empty: of the one that has the most.
  [[nodiscard]] std::optional<Id> who_gives_way(const std::string& address) const;

  int all_, an_address_, kept_;
  Id next_{1};
  std::map<Id, Held> held_;  ///< oldest first
  std::map<std::string, int> of_address_;
};

}  // namespace biteline::web
