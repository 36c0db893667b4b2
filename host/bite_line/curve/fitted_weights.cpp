// SPDX-License-Identifier: MIT
// The table that bench_curve_fit writes.
#include "host/bite_line/curve/curve_costs.hpp"

namespace biteline::bite_line {

const CurveWeights& fitted_weights() {
  static constexpr CurveWeights k_weights{
      .alone = {-4.489F, -0.068F, 3.735F, 2.571F, 2.152F, 1.083F, 1.037F, -0.790F, -1.159F, 2.199F, -0.318F,
                0.087F, -0.400F, 0.000F, 0.000F, 0.000F, 0.000F},
      .all = {-4.197F, -2.964F, 4.440F, 1.881F, 3.542F, 2.582F, 0.648F, -1.403F, -2.094F, 2.309F, -0.092F,
              -0.887F, -1.076F, -2.151F, -0.410F, 0.000F, 0.000F},
      .usual = {-3.979F, -1.089F, 1.839F, 1.390F, 3.337F, 2.749F, -0.029F, -0.794F, -1.461F, 2.760F, 0.176F,
                -0.124F, -0.595F, -1.903F, -0.444F, -4.121F, -2.286F}};
  return k_weights;
}

}  // namespace biteline::bite_line
