// SPDX-License-Identifier: MIT
#pragma once
/// \file How far the second scan lies across the first one, place by place along the line: what an arm does
/// not repeat of its way is height where the surface is steep.

#include "host/second_look/compare.hpp"

namespace biteline::second_look {

/// Each row is laid onto the first scan by its unworked cells and those of the rows near by; the differences
/// are then as if it lay there.  The line is `line_mm` long.
void take_shift_off(Change& change, const Compared& compared, const Zones& zones, double line_mm);

}  // namespace biteline::second_look
