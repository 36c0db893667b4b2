// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether the best course is the bite line, how sure that is, and why it is none.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/bite_line/path/layers.hpp"
#include "host/bite_line/path/seen_gates.hpp"
#include "host/bite_line/refused.hpp"
#include "host/bite_line/shoe/plan_shape.hpp"
#include "host/bite_line/side/seam_step.hpp"

namespace biteline::bite_line {

/// A closed path that was judged.
struct JudgedPath {
  bool passes{false};       ///< every gate that looks at it alone, and not at what else the line could be
  double confidence{0};     ///< 0 to 1
  std::vector<double> row;  ///< per column, in rows of the side's grid
  double mean_height_mm{0};
  double turn_rad{0};               ///< median turn of the surface across it
  double seen_share{0};             ///< of its columns
  std::vector<std::uint8_t> lacks;  ///< per column: bits of Lack; empty where nobody looked
};

struct Decision {
  std::optional<Refusal> refusal;  ///< why none is the bite line, or why a person must look first
  /// With a refusal: every gate that looks at the best path alone says yes.  So there is a line to show, and
  /// what speaks against it is what else it could be.
  bool for_review{false};
  double confidence{0};         ///< that the best path is the line, times the share of its length that holds
  double of_line{0};            ///< that it is the line wherever it keeps its layer
  std::vector<SeenGate> gates;  ///< of the best path, in the table's order
  std::vector<JudgedPath> paths;  ///< the best, then what else the line could be, the nearest first
};

/// What the gates say of a crease that look at it alone, whatever the outline: their product, 0 to 1.
[[nodiscard]] double sure_alone(const Crease& line);

/// What a bite line is, on what has a shoe's outline: a crease all the way round; an upper goes on above it;
/// below it the sole stands out, or at least the two are not one surface; and it keeps to one layer.
///
/// `seam`: how far the scan's end lies from its begin, where it shows both.
///
/// One table of gates.  Their product is the confidence, and the first that says no is the reason.  A gate is
/// hard, and then there is no line; or soft, and then a person decides.
[[nodiscard]] Decision decide(const Layers& layers, const PlanShape& plan,
                              const std::optional<SeamStep>& seam, double min_confidence);

}  // namespace biteline::bite_line
