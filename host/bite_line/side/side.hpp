// SPDX-License-Identifier: MIT
#pragma once
/// \file The shoe, its outline, and its side as a height field: what all that follows stands on.

#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/shoe/shoe.hpp"
#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

struct Side {
  Shoe shoe;
  Outline outline;
  SideField field;
};

}  // namespace biteline::bite_line
