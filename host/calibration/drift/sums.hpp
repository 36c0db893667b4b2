// SPDX-License-Identifier: MIT
#pragma once
/// \file Normal equations in the quantities.

#include "host/calibration/drift/quantities.hpp"

namespace biteline::drift {

/// information * x = pull, x what has drifted and by how much.  Sums of scans are sums of both.
struct Sums {
  Matrix information{Matrix::Zero()};
  Vector pull{Vector::Zero()};

  void add(const Matrix& more_information, const Vector& more_pull) {
    information += more_information;
    pull += more_pull;
  }
  /// Each quantity as if it alone had drifted, and its standard deviation; where nothing is said 0 and
  /// infinity.
  [[nodiscard]] Vector alone() const;
  [[nodiscard]] Vector alone_sigma() const;
};

}  // namespace biteline::drift
