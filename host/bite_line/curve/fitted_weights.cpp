// SPDX-License-Identifier: MIT
// The table that bench_curve_fit writes.
#include "host/bite_line/curve/curve_costs.hpp"

namespace biteline::bite_line {

const CurveWeights& fitted_weights() {
  static constexpr CurveWeights k_weights{
      .alone = {-4.421F, -0.048F, 3.766F, 2.558F, 2.220F, 0.333F, 1.217F, -0.309F, -1.193F, 2.142F, -0.152F,
                0.183F, -0.500F, 0.000F, 0.000F},
      .all = {-4.100F, -2.930F, 4.321F, 2.389F, 3.121F, -0.304F, 1.003F, 0.312F, -1.788F, 2.071F, 0.166F,
              -0.587F, -1.204F, -2.712F, 0.126F}};
  return k_weights;
}

}  // namespace biteline::bite_line
