// SPDX-License-Identifier: MIT
#pragma once
/// \file What the steps handed on to each other: kept for pictures when asked for.

#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

struct Workings {
  Side side;
  Decision decision;
  PlacedLine placed;  ///< empty when the decision is a refusal and not for review
};

}  // namespace biteline::bite_line
