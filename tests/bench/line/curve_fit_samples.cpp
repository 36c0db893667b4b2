// SPDX-License-Identifier: MIT
#include "tests/bench/line/curve_fit_samples.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "host/geometry/logistic.hpp"

namespace biteline::bench {

using bite_line::CreaseLooks;
using bite_line::k_crease_signs;
using bite_line::SignWeights;

std::vector<Sample> samples_of(const Held& held, std::size_t number, const CreaseLooks& looks,
                               const std::optional<SignWeights>& alone) {
  constexpr int k_any = 6000, k_tries = 60000;
  constexpr double k_like_crease = 0.3;
  std::vector<Sample> samples, any, creases;
  for (std::size_t i = 0; i < held.truth.size(); i += 2) {
    if (const std::optional<Passing> at = passing_at(held, looks, i))
      samples.push_back({looks.all(at->row, at->col, at->direction), true, 1, number});
  }
  const auto lines = static_cast<double>(samples.size());
  std::mt19937 random{static_cast<std::uint32_t>(number + 1)};
  for (int tries = 0; tries < (alone ? k_tries : k_any); ++tries) {
    const int row = std::uniform_int_distribution<int>{0, held.raster.rows - 1}(random);
    const int col = std::uniform_int_distribution<int>{0, held.raster.cols - 1}(random);
    const auto k = std::uniform_int_distribution<std::size_t>{0, bite_line::k_directions - 1}(random);
    const std::size_t cell = held.raster.at(row, col);
    if (held.raster.seen[cell] == 0 || (tries >= k_any && !looks.turns(cell, k))) continue;
    if (tries >= k_any && geometry::logistic(static_cast<double>(
                              bite_line::log_odds(*alone, looks.alone(row, col, k)))) < k_like_crease)
      continue;
    if (least_off_mm(held.raster.place(row, col), held.truth, held.turn_mm) < 2.5 + held.truth_mm) continue;
    (tries < k_any ? any : creases).push_back({looks.all(row, col, k), false, 0, number});
  }
  const double share = creases.empty() ? 1 : 0.5;
  for (std::vector<Sample>* of : {&any, &creases}) {
    for (Sample& sample : *of) {
      sample.weight = share * lines / static_cast<double>(of->size());
      samples.push_back(sample);
    }
  }
  return samples;
}

Eigen::VectorXd logistic_fit(const std::vector<Row>& rows, Eigen::Index n, double ridge) {
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < 50; ++round) {
    Eigen::VectorXd gradient = -ridge * w;
    Eigen::MatrixXd hessian = ridge * Eigen::MatrixXd::Identity(n, n);
    for (const Row& row : rows) {
      const double p = geometry::logistic(w.dot(row.signs));
      gradient += row.weight * ((row.yes ? 1.0 : 0.0) - p) * row.signs;
      hessian += row.weight * p * (1 - p) * row.signs * row.signs.transpose();
    }
    const Eigen::VectorXd step = hessian.ldlt().solve(gradient);
    w += step * std::min(1.0, 2.0 / std::max(step.cwiseAbs().maxCoeff(), 1e-9));
    if (step.cwiseAbs().maxCoeff() < 1e-5) break;
  }
  return w;
}

SignWeights fitted(const std::vector<Sample>& samples, const std::vector<Held>& held, std::size_t unused,
                   const std::string& left_out) {
  constexpr double k_ridge = 1e-3;
  const auto n = static_cast<Eigen::Index>(k_crease_signs - unused);
  std::map<bool, double> total;
  for (const Sample& sample : samples)
    if (held[sample.held].group != left_out) total[held[sample.held].made()] += sample.weight;
  std::vector<Row> rows;
  for (const Sample& sample : samples) {
    const Held& of = held[sample.held];
    if (of.group == left_out) continue;
    rows.push_back({.signs = Eigen::Map<const Eigen::Matrix<float, static_cast<int>(k_crease_signs), 1>>(
                                 sample.signs.data())
                                 .head(n)
                                 .cast<double>(),
                    .yes = sample.line,
                    .weight = sample.weight / total[of.made()]});
  }
  const Eigen::VectorXd w = logistic_fit(rows, n, k_ridge);
  SignWeights weights{};
  for (Eigen::Index i = 0; i < n; ++i) weights[static_cast<std::size_t>(i)] = static_cast<float>(w[i]);
  return weights;
}

}  // namespace biteline::bench
