// SPDX-License-Identifier: MIT
#include "host/calibration/drift/naming.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::drift {
namespace {

/// Standard deviation of what a part that has drifted has drifted by, in fault sizes.
constexpr double k_usual_drift = 2;
/// Small motions are taken as straight, lenses as they were: good to so much of what is seen.
constexpr double k_model_error = 0.05;
/// Of a logarithm of probabilities: beyond, all is nothing.
constexpr double k_never = -50;
/// Less probable than this is ruled out.
constexpr double k_ruled_out = 0.1;

std::vector<int> quantities_of(Part part) {
  std::vector<int> found;
  for (int i = 0; i < k_quantities; ++i) {
    if (k_table.at(static_cast<std::size_t>(i)).part == part) found.push_back(i);
  }
  return found;
}

struct Tried {
  double log_evidence{0};
  Vector drift{Vector::Zero()};
};

/// These quantities alone have drifted, all of them by something.
Tried try_quantities(const Sums& sums, double spread, const std::vector<int>& of) {
  const Eigen::MatrixXd A = sums.information(of, of) / spread;
  const Eigen::VectorXd b = sums.pull(of) / spread;
  const auto identity = Eigen::MatrixXd::Identity(A.rows(), A.cols());
  constexpr double k_variance = k_usual_drift * k_usual_drift;
  const Eigen::LLT<Eigen::MatrixXd> solver(A + identity / k_variance);
  const Eigen::VectorXd x = solver.solve(b);
  const Eigen::MatrixXd L = solver.matrixL();
  const double log_determinant =
      2 * L.diagonal().array().log().sum() + static_cast<double>(of.size()) * std::log(k_variance);
  Tried tried{.log_evidence = 0.5 * b.dot(x) - 0.5 * log_determinant, .drift = Vector::Zero()};
  tried.drift(of) = x;
  return tried;
}

/// As often one quantity of a part drifts as all of them together: a part with many is not ruled out for
/// having many.  The drift is that of the likeliest reading.
Tried try_part(const Sums& sums, double spread, Part part) {
  const std::vector<int> all = quantities_of(part);
  std::vector<Tried> readings{try_quantities(sums, spread, all)};
  std::vector<double> weights{0.5};
  for (const int one : all) {
    readings.push_back(try_quantities(sums, spread, {one}));
    weights.push_back(0.5 / static_cast<double>(all.size()));
  }
  const auto best = std::ranges::max_element(readings, {}, &Tried::log_evidence);
  double sum = 0;
  for (std::size_t i = 0; i < readings.size(); ++i)
    sum += weights[i] * std::exp(std::max(readings[i].log_evidence - best->log_evidence, k_never));
  return {.log_evidence = best->log_evidence + std::log(sum), .drift = best->drift};
}

}  // namespace

Named name(const Sums& sums, double spread) {
  spread = std::max(spread, 1.0);
  const Matrix held = sums.information + Matrix::Identity() / (k_usual_drift * k_usual_drift);
  const Vector explained = geometry::solve_symmetric(held, sums.pull);
  const double seen = sums.pull.dot(explained) / k_quantities;
  spread += k_model_error * k_model_error * std::max(seen, 0.0);
  std::array<Tried, k_parts> tried;
  for (std::size_t p = 0; p < k_parts; ++p) tried.at(p) = try_part(sums, spread, static_cast<Part>(p));
  const auto best = std::ranges::max_element(tried, {}, &Tried::log_evidence);
  Named named{.probability = {}, .part = static_cast<Part>(best - tried.begin()), .drift = best->drift};
  double sum = 0;
  for (std::size_t p = 0; p < k_parts; ++p)
    sum += named.probability.at(p) =
        std::exp(std::max(tried.at(p).log_evidence - best->log_evidence, k_never));
  for (double& probability : named.probability) probability /= sum;
  return named;
}

std::string words_of(const Named& named) {
  std::string words{k_part_names.at(static_cast<std::size_t>(named.part))};
  for (std::size_t p = 0; p < k_parts; ++p) {
    if (p != static_cast<std::size_t>(named.part) && named.probability.at(p) > k_ruled_out)
      words += " or " + std::string(k_part_names.at(p));
  }
  return words;
}

std::string largest_of(const Named& named) {
  Eigen::Index at = 0;
  (void)named.drift.cwiseAbs().maxCoeff(&at);
  const Quantity& quantity = k_table.at(static_cast<std::size_t>(at));
  return std::string{FixedText<80>::format("%s %+.3f %s", std::string(quantity.name).c_str(),
                                           named.drift[at] * quantity.size,
                                           std::string(quantity.unit).c_str())
                         .view()};
}

}  // namespace biteline::drift
