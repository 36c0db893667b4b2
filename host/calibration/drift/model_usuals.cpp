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

std::string ModelUsuals::name_of(const std::string& model) const {
  return of_.contains(model) || of_.size() < k_most ? model : k_others;
}

ModelUsuals::Usual& ModelUsuals::own(const std::string& model) {
  if (of_.empty()) first_ = model;
  return of_[name_of(model)];
}

void ModelUsuals::forget(const std::string& model, const Sums& seen) {
  Usual& own = this->own(model);
  own.sums.add(-seen.information, -seen.pull);
  own.alone -= seen.alone();
  --own.shoes;
}

std::optional<TablePlane> ModelUsuals::table_of(const std::string& model) const {
  const auto found = of_.find(name_of(model));
  return found == of_.end() ? std::nullopt : found->second.table;
}

std::optional<ModelUsuals::Said> ModelUsuals::take(const std::string& model, const Sums& seen, bool learns) {
  Usual& own = this->own(model);
  const Usual& first = of_[first_];
  std::optional<Said> said;
  if (own.shoes >= k_least && first.shoes >= k_least) {
    Sums left = seen;
    left.pull -= left.information * explained(own.sums);
    said = Said{.alone = left.alone() + first.alone / first.shoes, .left = left};
  }
  if (is_first(model)) said = Said{.alone = seen.alone(), .left = said ? said->left : std::nullopt};
  if (learns) {
    own.sums.add(seen.information, seen.pull);
    own.alone += seen.alone();
    ++own.shoes;
  }
  return said;
}

}  // namespace biteline::drift
