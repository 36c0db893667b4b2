// SPDX-License-Identifier: MIT
#pragma once
/// \file Made shoes with a guard on the toe, and their unrolled side.

#include <cstdint>
#include <utility>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "tests/support/line_sweep.hpp"

namespace biteline::test {

/// Seed of shoes that no figure of the detours was fitted to.
inline constexpr std::uint64_t k_guard_seed = 4711;

inline SweepCell with_guard(std::uint64_t index, bool guard = true) {
  SweepCell cell = sweep_cell(k_guard_seed, index);
  cell.fault = CloudFault::None;
  cell.shoe.toe_guard = guard;
  return cell;
}

/// The `k`-th shoe of the seed that has a designed sole.
inline std::uint64_t designed(int k) {
  std::uint64_t index = 0;
  for (;; ++index)
    if (sim::is_designed(with_guard(index).shoe.shoe_class) && k-- == 0) return index;
}

inline bite_line::Side side_of(const SweepScan& scan) {
  bite_line::Shoe shoe = *bite_line::find_shoe(scan.cloud.points);
  bite_line::Outline outline = bite_line::side_outline(shoe);
  bite_line::SideField field = bite_line::SideField::build(shoe, outline, {});
  return {std::move(shoe), std::move(outline), std::move(field)};
}

}  // namespace biteline::test
