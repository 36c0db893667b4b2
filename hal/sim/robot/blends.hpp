// SPDX-License-Identifier: MIT
#pragma once
/// \file What a real controller does about blends that meet: it skips the move and warns.

#include <string>
#include <vector>

#include "hal/sim/robot/script.hpp"

namespace biteline::sim {

/// Takes out each straight or process move whose blend reaches into that of the move before it (together
/// wider than the two goals are apart); one warning for each.  Universal Robots, script manual, movel: such a
/// move "will be skipped, and an 'Overlapping Blends' warning message will be generated"; that movep does the
/// same is taken for granted.  Where a chain of moves begins (after anything that is no move with a pose)
/// nothing is known of the place before, and nothing is skipped.
[[nodiscard]] std::vector<std::string> skip_overlapping_blends(Script& script);

}  // namespace biteline::sim
