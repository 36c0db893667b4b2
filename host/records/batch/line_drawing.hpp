// SPDX-License-Identifier: MIT
#pragma once
/// \file Lines as pictures (SVG): from above, and below it from the side.

#include <span>
#include <string>
#include <vector>

#include "host/records/batch/outcome.hpp"

namespace biteline::batch {

/// One line of a picture's panel.
struct DrawnLine {
  std::span<const LinePlace> places;
  std::vector<bool> marked;  ///< drawn red; empty: none
  bool thin{false};          ///< a truth: thin and blue
};

struct DrawnPanel {
  std::string title;
  std::vector<DrawnLine> lines;
};

/// Panels side by side, all at one scale.
[[nodiscard]] std::string draw_lines(const std::vector<DrawnPanel>& panels);

}  // namespace biteline::batch
