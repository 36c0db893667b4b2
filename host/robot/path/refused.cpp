// SPDX-License-Identifier: MIT
#include "host/robot/path/refused.hpp"

#include <array>

namespace biteline::path {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  using enum Refused;
  using Row = report::RefusalRow<Refused>;
  static constexpr std::array k_rows{
      Row{LineUnfit, "line_unfit", "find the line again, or repair the row that the reason names"},
      Row{CannotFollow, "cannot_follow", "move the shoe or tilt the tool as the reason says"},
      Row{PathCheckFailed, "path_check_failed",
          "change what the failed check names: process, shoe's place or tool"},
      Row{NoFreeWayToBegin, "no_free_way_to_begin", "jog the arm to a place above the shoe and plan again"},
      Row{NotAsTaught, "not_as_taught",
          "mount the process's tool, choose the process of the mounted one, or teach it again"},
  };
  return k_rows;
}

}  // namespace biteline::path
