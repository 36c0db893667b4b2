// SPDX-License-Identifier: MIT
#pragma once
/// \file Samples of line and surface, and logistic fits to them.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "host/bite_line/curve/crease_looks.hpp"
#include "tests/bench/line/curve_fit_held.hpp"

namespace biteline::bench {

/// A place that is the line, or is not.
struct Sample {
  bite_line::CreaseSigns signs;
  bool line;
  double weight;
  std::size_t held;  ///< number of its side
};

/// Places of surface: any, and once they can be told, as many that look like a crease, which count as much.
/// Plain surface is easy to tell from the line; which of several creases it is, is the question.
[[nodiscard]] std::vector<Sample> samples_of(const Held& held, std::size_t number,
                                             const bite_line::CreaseLooks& looks,
                                             const std::optional<bite_line::SignWeights>& alone);

/// Of a logistic regression.
struct Row {
  Eigen::VectorXd signs;
  bool yes;
  double weight;
};

/// Newton's method with a ridge; `n` signs a row.
[[nodiscard]] Eigen::VectorXd logistic_fit(const std::vector<Row>& rows, Eigen::Index n, double ridge);

/// The last `unused` signs stay 0.  Made shoes count half, and shapes do.
[[nodiscard]] bite_line::SignWeights fitted(const std::vector<Sample>& samples, const std::vector<Held>& held,
                                            std::size_t unused, const std::string& left_out);

}  // namespace biteline::bench
