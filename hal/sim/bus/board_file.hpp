// SPDX-License-Identifier: MIT
#pragma once
/// \file The board.yaml that a simulated cell answers to.

#include <string>

namespace biteline::sim {

struct CellAddress {
  std::string wires;                ///< name of the simulated wires
  std::string camera{"127.0.0.1"};  ///< where its GigE Vision camera answers
  bool monostable{false};           ///< the cell has one before its laser, fed by a heartbeat
};

/// boards/sim/board.yaml with this cell's addresses, and `laser.heartbeat` where the cell has a monostable.
[[nodiscard]] std::string board_yaml_text(const CellAddress& cell);

}  // namespace biteline::sim
