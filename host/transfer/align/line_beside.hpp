// SPDX-License-Identifier: MIT
#pragma once
/// \file The closed bite line beside a point of the shoe, seen from above.

#include <algorithm>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/transfer/align/surfels.hpp"

namespace biteline::transfer {

/// Anticlockwise, so outward is to the right.  Keeps a thinned copy: its height and course count, not its
/// grain.
class LineBeside {
 public:
  explicit LineBeside(const std::vector<Vec3>& line) {
    constexpr std::size_t k_points = 250;  // 3 mm apart on a shoe
    const std::size_t step = std::max<std::size_t>(1, line.size() / k_points);
    for (std::size_t i = 0; i < line.size(); i += step) line_.push_back(line[i]);
    way_mm_.push_back(0);
    for (std::size_t i = 0; i < line_.size(); ++i)
      way_mm_.push_back(way_mm_.back() + (line_[(i + 1) % line_.size()] - line_[i]).norm());
  }

  struct Place {
    double height_mm;
    Foot foot;
    double along_mm;  ///< on the line, from its first point
  };

  [[nodiscard]] double length_mm() const { return way_mm_.back(); }

  [[nodiscard]] Place at(const Vec3& point) const {
    std::size_t nearest = 0;
    double best = (line_.front() - point).head<2>().squaredNorm();
    for (std::size_t i = 1; i < line_.size(); ++i) {
      const double squared = (line_[i] - point).head<2>().squaredNorm();
      if (squared < best) {
        best = squared;
        nearest = i;
      }
    }
    const std::size_t before = nearest == 0 ? line_.size() - 1 : nearest - 1;
    const Vec3 on_before = on_segment(before, point), on_after = on_segment(nearest, point);
    const bool is_before =
        (on_before - point).head<2>().squaredNorm() < (on_after - point).head<2>().squaredNorm();
    const Vec3& place = is_before ? on_before : on_after;
    return {.height_mm = place.z(),
            .foot = {.place = place.head<2>().cast<float>(), .outward = outward_at(nearest)},
            .along_mm = is_before ? way_mm_[before] + (place - line_[before]).norm()
                                  : way_mm_[nearest] + (place - line_[nearest]).norm()};
  }

 private:
  [[nodiscard]] Eigen::Vector2f outward_at(std::size_t i) const {
    const Vec3 along = line_[(i + 1) % line_.size()] - line_[i == 0 ? line_.size() - 1 : i - 1];
    return Vec2{along.y(), -along.x()}.normalized().cast<float>();
  }

  [[nodiscard]] Vec3 on_segment(std::size_t i, const Vec3& point) const {
    const Vec3& a = line_[i];
    const Vec3 d = line_[(i + 1) % line_.size()] - a;
    const double squared = d.head<2>().squaredNorm();
    const double share =
        squared > 0 ? std::clamp((point - a).head<2>().dot(d.head<2>()) / squared, 0.0, 1.0) : 0;
    return a + share * d;
  }

  std::vector<Vec3> line_;
  std::vector<double> way_mm_;  ///< to each point, and all the way round
};

}  // namespace biteline::transfer
