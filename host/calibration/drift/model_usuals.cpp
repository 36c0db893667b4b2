// SPDX-License-Identifier: MIT
#include "host/calibration/drift/model_usuals.hpp"

#include <utility>

#include "host/geometry/symmetric.hpp"

namespace biteline::drift {
namespace {

constexpr const char* k_others = "(others)";

}  // namespace

Vector explained(const Sums& sums) {
  const Matrix held = sums.information + Matrix::Identity() / (k_usual_size * k_usual_size);
  return geometry::solve_symmetric(held, sums.pull);
}

ModelUsuals::ModelUsuals(std::string first, std::map<std::string, Usual> of)
    : first_{std::move(first)}, of_{std::move(of)} {}

std::optional<ModelUsuals::Said> ModelUsuals::take(const std::string& model, const Sums& seen, bool learns) {
  if (of_.empty()) first_ = model;
  const std::string& name = of_.contains(model) || of_.size() < k_most ? model : k_others;
  Usual& own = of_[name];
  const Usual& first = of_[first_];
  std::optional<Said> said;
  if (name == first_) {
    said = Said{.sums = seen, .alone = seen.alone()};
  } else if (own.shoes >= k_least && first.shoes >= k_least) {
    const Vector usual = explained(own.sums);
    Sums left = seen;
    left.pull -= left.information * usual;
    said = Said{.sums = left, .alone = left.alone() + first.alone / first.shoes};
    said->sums.pull += said->sums.information * explained(first.sums);
  }
  if (learns) {
    own.sums.add(seen.information, seen.pull);
    own.alone += seen.alone();
    ++own.shoes;
  }
  return said;
}

}  // namespace biteline::drift
