// SPDX-License-Identifier: MIT
#include "host/bite_line/shoe/plan_shape.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace biteline::bite_line {

PlanShape plan_shape(const Outline& outline) {
  constexpr std::size_t k_slices = 200;
  const auto point = [&](int i) { return outline.point(outline.spacing_mm() * i); };
  double low = point(0).x();
  double high = low;
  for (int i = 0; i < outline.samples(); ++i) {
    low = std::min(low, point(i).x());
    high = std::max(high, point(i).x());
  }
  const double length = std::max(high - low, 1e-6);
  std::vector<double> left(k_slices + 1, -1e9);
  std::vector<double> right(k_slices + 1, 1e9);
  const auto slice_of = [&](double x) {
    return static_cast<std::size_t>(std::clamp((x - low) / length, 0.0, 1.0) * k_slices);
  };
  for (int i = 0; i < outline.samples(); ++i) {
    const Vec2 a = point(i);
    const Vec2 b = point(i + 1);
    const std::size_t from = slice_of(a.x());
    const std::size_t to = slice_of(b.x());
    for (std::size_t slice = std::min(from, to); slice <= std::max(from, to); ++slice) {
      left[slice] = std::max({left[slice], a.y(), b.y()});
      right[slice] = std::min({right[slice], a.y(), b.y()});
    }
  }
  const auto breadth = [&](std::size_t slice) { return std::max(left[slice] - right[slice], 0.0); };
  double most = 1e-6;
  for (std::size_t slice = 0; slice <= k_slices; ++slice) most = std::max(most, breadth(slice));

  PlanShape shape;
  for (std::size_t i = 0; i < shape.breadth.size(); ++i)
    shape.breadth[i] = breadth(static_cast<std::size_t>(PlanShape::k_at[i] * k_slices)) / most;
  double first = 1;
  double last = 0;
  for (std::size_t slice = 0; slice <= k_slices; ++slice) {
    if (breadth(slice) < 0.98 * most) continue;
    first = std::min(first, static_cast<double>(slice) / k_slices);
    last = std::max(last, static_cast<double>(slice) / k_slices);
  }
  shape.broadest_at = 0.5 * (first + last);
  shape.breadth_to_length = most / length;
  return shape;
}

}  // namespace biteline::bite_line
