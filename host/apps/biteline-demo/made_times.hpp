// SPDX-License-Identifier: MIT
#pragma once
/// \file What a shoe took in made time: that of the simulated arm, whatever share of real time it went at.

#include <filesystem>
#include <istream>
#include <optional>
#include <string>

#include "common/core/result.hpp"

namespace biteline::demo {

/// All measured: the arm's by its own track, the computing's by the service's clock.
struct MadeTimes {
  double scan_s{0};           ///< of the stripe, from begin to end
  double rest_s{0};           ///< from there until the arm stands
  double line_and_path_s{0};  ///< computed, from the last profile to the checked path
  double sets_out_s{0};       ///< from the scan's end until the arm sets out; holds rest, line and path
  double way_there_s{0}, approach_s{0}, work_s{0}, retreat_s{0};
  [[nodiscard]] double whole_s() const {
    return scan_s + sets_out_s + way_there_s + approach_s + work_s + retreat_s;
  }
};

/// Of the arm's last scan and the program after it.
struct ArmTimes {
  double scan_s{0}, rest_s{0};  ///< made time
  double rest_real_s{0};        ///< the same in real time
  double gap_real_s{0};         ///< from the scan's end until the program begins
  double program_s{0};
};

/// Of a cell's track.csv; nothing where no program ran after the scan.
[[nodiscard]] std::optional<ArmTimes> arm_times(std::istream& track);

/// From the cell's folder and the service's result folder; nothing where the arm did not follow a path.
[[nodiscard]] std::optional<MadeTimes> made_times(const std::filesystem::path& cell,
                                                  const std::filesystem::path& scan);

/// One line for a person.
[[nodiscard]] std::string words(const MadeTimes& times);

}  // namespace biteline::demo
