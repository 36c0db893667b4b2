// SPDX-License-Identifier: MIT
// The table that bench_curve_fit writes.
#include "host/bite_line/curve/curve_costs.hpp"

namespace biteline::bite_line {

const CurveWeights& fitted_weights() {
  static constexpr CurveWeights k_weights{
      .alone = {-4.245F, -0.173F, 3.548F, 2.370F, 1.996F, 0.243F, 1.129F, -0.327F, -1.388F, 2.577F, 0.098F,
                -0.016F, -0.267F, 0.000F, 0.000F},
      .all = {-4.234F, -0.017F, 3.479F, 2.277F, 1.929F, 0.093F, 1.244F, -0.173F, -1.466F, 2.541F, 0.330F,
              0.072F, -0.239F, -1.260F, -0.010F}};
  return k_weights;
}

}  // namespace biteline::bite_line
