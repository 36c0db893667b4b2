// SPDX-License-Identifier: MIT
#pragma once
/// \file Counts what a unit goes through and keeps it over restarts, in few writes.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/upkeep/upkeep.hpp"

namespace biteline::upkeep {

/// The machine's time and boot.
struct Boot {
  std::string id{};  ///< as the kernel names this boot; empty: it does not
  double up_s{0};    ///< since then, time asleep included
};
/// As Linux tells them now.
[[nodiscard]] Boot present_boot();
[[nodiscard]] double since_boot_s();

/// What is seen of the unit at one moment.
struct Look {
  double up_s{0};  ///< since the machine's boot, time asleep included
  bool laser_on{false};
  std::optional<double> head_degc{};
  std::uint64_t frames{0};  ///< since the program's start
};

/// Writes at the start, every ten minutes and at the end; a kill costs what came since.  Never while the
/// laser is on: a thread that waits for the disk would hold its line. Thread: one owner.  Not for real-time
/// threads.
class UpkeepKeeper {
 public:
  /// Reads `folder`/upkeep.yaml, counts this start and writes it.  A file that is not whole is set aside as
  /// upkeep.bad.yaml and the count begins anew.  Errc::WriteFailed: there is no such folder, or no room.
  [[nodiscard]] static Result<UpkeepKeeper> open(const std::filesystem::path& folder, const Boot& boot);

  /// Some ten times a second or more: the laser's time is as exact as that.
  void see(const Look& look);
  /// True: at least ten minutes were not written yet, and it is dark.
  [[nodiscard]] bool due() const;
  [[nodiscard]] Result<void> write();

  [[nodiscard]] const Upkeep& upkeep() const { return upkeep_; }

 private:
  UpkeepKeeper(std::filesystem::path folder, Upkeep upkeep, double up_s);

  std::filesystem::path folder_;
  Upkeep upkeep_;
  double seen_s_, written_s_;
  std::uint64_t seen_frames_{0};
  bool lit_{false};
};

}  // namespace biteline::upkeep
