// SPDX-License-Identifier: MIT
#pragma once
/// \file What both methods start from: the shoe, its outline, its side as a height field.

#include <optional>
#include <span>

#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/shoe/shoe.hpp"
#include "host/bite_line/side/side_field.hpp"
#include "host/bite_line/stage_clock.hpp"

namespace biteline::bite_line {

struct Side {
  Shoe shoe;
  Outline outline;
  SideField field;
};

/// Shoe, outline and height field of a cloud; nothing, and the reason in the extraction, when there is no
/// shoe.
[[nodiscard]] std::optional<Side> make_side(std::span<const Eigen::Vector3f> points, StageClock& clock,
                                            Extraction& extraction);

/// The upper's normal beside the line, from the height field: mean over 2 to 6 mm above.
[[nodiscard]] Vec3 normal_from_field(const Side& side, const Vec3& p);

}  // namespace biteline::bite_line
