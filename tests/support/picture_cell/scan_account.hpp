// SPDX-License-Identifier: MIT
#pragma once
/// \file A host's account of one scan of the picture cell: what came, what of it is right, what is missing.

#include <map>
#include <optional>
#include <vector>

#include "host/intake/host_protocol.hpp"
#include "tests/support/picture_cell/picture_cell.hpp"

namespace biteline::test {

/// Thread: one owner.
class ScanAccount {
 public:
  explicit ScanAccount(const PictureCell& cell) : cell_{&cell}, expected_{cell.expected_profiles()} {}

  /// A new scan.
  void clear();
  void take(const intake::LinkEvent& event);

  std::uint64_t profiles{0};
  std::uint64_t usable{0};
  std::uint64_t wrong{0};                          ///< points of no picture of the cell, bit for bit
  std::uint64_t disordered{0};                     ///< profiles that came twice or out of order
  std::uint64_t frames_missing{0};                 ///< holes in the frames' numbers between the profiles
  std::uint64_t lost{0};                           ///< messages that the sensor no longer had
  std::map<std::uint32_t, std::uint64_t> flagged;  ///< by profile::ProfileFlag
  double pose_off_max_mm{0};                       ///< of usable profiles, against the cell's truth
  std::optional<std::uint64_t> last_profile, last_frame;
  wire::Health health;  ///< the newest
  std::uint64_t healths{0};
  std::optional<wire::EndOfScan> end;

  [[nodiscard]] std::uint64_t with(std::uint32_t flag) const {
    const auto found = flagged.find(flag);
    return found == flagged.end() ? 0 : found->second;
  }

 private:
  void take_profile(const profile::Profile& profile);

  const PictureCell* cell_;
  std::vector<std::vector<profile::ProfilePoint>> expected_;
};

}  // namespace biteline::test
