// SPDX-License-Identifier: MIT
#include "host/bite_line/level/branches.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

class BranchLook {
 public:
  BranchLook(const Patch& patch, const StepCosts& costs, std::span<const Vec2> way,
             const BranchConfig& config)
      : patch_{patch}, costs_{costs}, places_{way}, config_{config}, near_way_(patch.size(), 0) {
    for (const Vec2& place : way) patch.mark_about(patch.cell(place), config.apart_mm, near_way_);
  }

  void look_at(std::size_t i, Branches& found) const {
    const std::optional<Vec2> before = towards(i, -1), behind = towards(i, 1);
    if (!before || !behind) return;
    if (std::acos(std::clamp(-before->dot(*behind), -1.0, 1.0)) < config_.least_turn_rad) return;
    if (goes_on(places_[i], -*before, -*before)) found.off.push_back(i);
    if (goes_on(places_[i], -*behind, *behind)) found.onto.push_back(i);
  }

 private:
  /// The direction from a cell of the way to the one a lever away; none near an end.
  [[nodiscard]] std::optional<Vec2> towards(std::size_t i, int sign) const {
    std::size_t k = i;
    while ((places_[k] - places_[i]).norm() < config_.lever_mm) {
      if (k == (sign < 0 ? 0 : places_.size() - 1)) return std::nullopt;
      k = sign < 0 ? k - 1 : k + 1;
    }
    return (places_[k] - places_[i]).normalized();
  }

  /// Whether a plain crease lies all along `to` from a place; a way on it leads `along`.
  [[nodiscard]] bool goes_on(const Vec2& from, const Vec2& to, const Vec2& along) const {
    constexpr double k_spread = 0.1;
    int shows = 0, all = 0;
    for (double mm = config_.from_mm; mm <= config_.to_mm; mm += Patch::k_cell_mm, ++all) {
      const double beside_mm = config_.beside_mm + k_spread * mm;
      const Vec2 at = from + mm * to;
      for (double d = -beside_mm; d <= beside_mm; d += Patch::k_cell_mm) {
        if (!is_plain(at + d * Vec2{-to.y(), to.x()}, along)) continue;
        ++shows;
        break;
      }
    }
    return shows >= config_.least_share * all;
  }

  [[nodiscard]] bool is_plain(const Vec2& at, const Vec2& along) const {
    constexpr double k_direction_rad = std::numbers::pi / 8;
    const double row = std::floor((at.y() - patch_.window.z_mm) / Patch::k_cell_mm);
    const double col = std::floor((at.x() - patch_.window.s_mm) / Patch::k_cell_mm);
    if (row < 0 || row >= patch_.rows || col < 0 || col >= patch_.cols) return false;
    const std::size_t cell = patch_.at(static_cast<int>(row), static_cast<int>(col));
    if (patch_.seen[cell] == 0 || near_way_[cell] != 0) return false;
    const auto k = std::lround(std::atan2(along.y(), along.x()) / k_direction_rad);
    for (const long other : {k - 1, k, k + 1})
      if (costs_[geometry::round_index(0, other, costs_.size())][cell] <= config_.plain_cost) return true;
    return false;
  }

  const Patch& patch_;
  const StepCosts& costs_;
  std::span<const Vec2> places_;
  const BranchConfig& config_;
  std::vector<std::uint8_t> near_way_;  ///< per cell
};

}  // namespace

Branches branches(const Patch& patch, const StepCosts& bare_costs, std::span<const Vec2> way,
                  const BranchConfig& config) {
  const BranchLook look{patch, bare_costs, way, config};
  Branches found;
  for (std::size_t i = 0; i < way.size(); ++i) look.look_at(i, found);
  return found;
}

}  // namespace biteline::bite_line
