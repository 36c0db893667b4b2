// SPDX-License-Identifier: MIT
#include "host/calibration/drift/sums.hpp"

#include <cmath>
#include <limits>

namespace biteline::drift {

Vector Sums::alone() const {
  Vector x = Vector::Zero();
  for (int i = 0; i < k_quantities; ++i) {
    if (information(i, i) > 0) x[i] = pull[i] / information(i, i);
  }
  return x;
}

Vector Sums::alone_sigma() const {
  Vector sigma = Vector::Constant(std::numeric_limits<double>::infinity());
  for (int i = 0; i < k_quantities; ++i) {
    if (information(i, i) > 0) sigma[i] = 1 / std::sqrt(information(i, i));
  }
  return sigma;
}

}  // namespace biteline::drift
