// SPDX-License-Identifier: MIT
// The table that bench_curve_fit writes.
#include "host/bite_line/curve/curve_costs.hpp"

namespace biteline::bite_line {

const CurveWeights& fitted_weights() {
  static constexpr CurveWeights k_weights{
      .alone = {-4.245F, -0.173F, 3.548F, 2.370F, 1.996F, 0.243F, 1.129F, -0.327F, -1.388F, 2.577F, 0.098F,
                -0.016F, -0.267F, 0.000F, 0.000F},
      .all = {-3.923F, -3.625F, 4.085F, 2.161F, 3.045F, -0.027F, 0.861F, 0.173F, -2.343F, 2.535F, 0.922F,
              -0.935F, -0.959F, -1.985F, -0.123F}};
  return k_weights;
}

}  // namespace biteline::bite_line
