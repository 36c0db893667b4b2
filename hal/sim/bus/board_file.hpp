// SPDX-License-Identifier: MIT
#pragma once
/// \file The board.yaml that a simulated cell answers to.

#include <string>

namespace biteline::sim {

struct CellAddress {
  std::string wires;                ///< name of the simulated wires
  std::string camera{"127.0.0.1"};  ///< where its GigE Vision camera answers
};

/// boards/sim/board.yaml with this cell's addresses.
[[nodiscard]] std::string board_yaml_text(const CellAddress& cell);

}  // namespace biteline::sim
