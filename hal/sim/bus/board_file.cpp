// SPDX-License-Identifier: MIT
#include "hal/sim/bus/board_file.hpp"

#include <string_view>

#include "hal/sim/bus/sim_board_yaml.hpp"

namespace biteline::sim {
namespace {

void replace_all(std::string& text, std::string_view old_part, const std::string& new_part) {
  for (std::size_t at = text.find(old_part); at != std::string::npos;
       at = text.find(old_part, at + new_part.size())) {
    text.replace(at, old_part.size(), new_part);
  }
}

}  // namespace

std::string board_yaml_text(const CellAddress& cell) {
  std::string text{k_sim_board_yaml};
  if (cell.monostable) {
    replace_all(text, "laser:\n",
                "laser:\n  heartbeat: {chip: sim:biteline-cell, line: heartbeat, bias: pull-down}\n");
  }
  replace_all(text, "sim:biteline-cell", "sim:" + cell.wires);
  replace_all(text, "address: 127.0.0.1", "address: " + cell.camera);
  return text;
}

}  // namespace biteline::sim
