// SPDX-License-Identifier: MIT
#include "host/bite_line/side/side_outline.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace biteline::bite_line {

Outline side_outline(const Shoe& shoe) {
  constexpr float k_band_mm = 45.0F;
  constexpr float k_cell_mm = 1.0F;
  // Only the outermost point of each row of the plan can lie on the hull.
  using Ends = std::vector<std::pair<Eigen::Vector2f, Eigen::Vector2f>>;
  const auto rows = static_cast<std::size_t>(shoe.box.sizes().y() / k_cell_mm) + 1;
  const auto widen = [](Ends::value_type& row, const Ends::value_type& by) {
    if (by.first.x() < row.first.x()) row.first = by.first;
    if (by.second.x() > row.second.x()) row.second = by.second;
  };
  const Ends ends = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>{0, shoe.points.size(), 8192}, Ends(rows, {{1e9F, 0}, {-1e9F, 0}}),
      [&](const auto& range, Ends seen) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const Eigen::Vector3f& p = shoe.points[i];
          if (shoe.alone[i] != 0 || p.z() > shoe.box.min().z() + k_band_mm) continue;
          const auto row = static_cast<std::size_t>((p.y() - shoe.box.min().y()) / k_cell_mm);
          widen(seen[row], {p.head<2>(), p.head<2>()});
        }
        return seen;
      },
      [&](Ends a, const Ends& b) {
        for (std::size_t row = 0; row < a.size(); ++row) widen(a[row], b[row]);
        return a;
      });
  std::vector<Vec2> plan;
  for (const auto& [low, high] : ends) {
    if (low.x() > 1e8F) continue;
    plan.push_back(low.cast<double>());
    plan.push_back(high.cast<double>());
  }
  return Outline{convex_hull(std::move(plan)), {}};
}

}  // namespace biteline::bite_line
