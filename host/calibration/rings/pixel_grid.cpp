// SPDX-License-Identifier: MIT
#include "host/calibration/rings/pixel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace biteline::calibration {

namespace {

/// Noise of one edge point, and the shifts that sampling makes (even over +- half a pixel): their squared
/// ratio is the ridge.
constexpr double k_edge_sigma_px = 0.1, k_shift_sigma_px = 0.29;
/// Neighbours on an edge share much of their noise (one blur): every second is looked at, and counts less
/// than a whole one.
constexpr std::size_t k_point_step = 2;
constexpr double k_point_weight = 0.6;
/// Lens and pixel blur, along which an edge takes the mean of the shifts.  Lenses have 0.6 to 1.3 px; the
/// result depends little on it.
constexpr double k_blur_px = 1.0;
/// Shifts are kept free of what is wider than this: a ring of 30 px or more can take that into its ellipse.
constexpr double k_fine_px = 12;
/// Columns and rows in turn, which hardly depend on each other; ellipses and shifts in turn.
constexpr int k_sweeps = 3, k_grid_rounds = 2;
/// Shifts that tell less of unseen pictures' edges are noise, or of another kind; a scaler's tell over half.
constexpr double k_least_explained_ratio = 0.1;
/// An edge that runs along a column or a row keeps one and the same error for many pixels; after correction
/// its points are twice as far off as all others, and not independent.
constexpr double k_least_slant_rad = 8 * std::numbers::pi / 180;

using Shifts = std::array<std::vector<double>, 2>;  ///< per column along u, per row along v
using Pictures = std::vector<const std::vector<Ring>*>;

/// Weights of the blur along an edge.
struct Blur {
  static constexpr int k_nodes = 7, k_middle = k_nodes / 2;
  std::array<double, k_nodes> place_px{}, weight{};

  Blur() {
    double sum = 0;
    for (std::size_t k = 0; k < k_nodes; ++k) {
      const double sigmas = 0.8 * (static_cast<double>(k) - k_middle);
      place_px[k] = k_blur_px * sigmas;
      weight[k] = std::exp(-0.5 * sigmas * sigmas);
      sum += weight[k];
    }
    for (double& w : weight) w /= sum;
  }
};

const Blur k_blur;

struct EdgePoint {
  Vec2 place_px;
  Vec2 normal;
  double distance_px;  ///< beyond its ellipse along the normal

  /// How far the edge runs along an axis per pixel of its length.
  [[nodiscard]] double run(int axis) const { return axis == 0 ? -normal.y() : normal.x(); }
};

/// Columns (or rows) whose shifts an edge point takes, with what share.
struct Reach {
  static constexpr int k_span = 10;  ///< all nodes of the blur, with both neighbours each
  int first{0};
  std::array<double, k_span> share{};

  Reach(const EdgePoint& point, int axis) {
    first = static_cast<int>(std::floor(point.place_px[axis])) - k_span / 2 + 1;
    for (std::size_t k = 0; k < Blur::k_nodes; ++k) {
      const double place = point.place_px[axis] + k_blur.place_px[k] * point.run(axis);
      const int left = static_cast<int>(std::floor(place));
      const double f = place - left;
      const auto i = static_cast<std::size_t>(left - first);
      share[i] += k_blur.weight[k] * (1 - f);
      share[i + 1] += k_blur.weight[k] * f;
    }
  }
  [[nodiscard]] bool within(const std::vector<double>& shifts) const {
    return first >= 0 && first + k_span <= static_cast<int>(shifts.size());
  }
  [[nodiscard]] double mean(const std::vector<double>& shifts) const {
    if (!within(shifts)) return 0;
    double sum = 0;
    for (int i = 0; i < k_span; ++i)
      sum += share[static_cast<std::size_t>(i)] * shifts[static_cast<std::size_t>(first + i)];
    return sum;
  }
};

/// How far the grid puts an edge point out along its normal.
double put_out(const EdgePoint& point, const Shifts& shifts) {
  return point.normal.x() * Reach(point, 0).mean(shifts[0]) +
         point.normal.y() * Reach(point, 1).mean(shifts[1]);
}

Vec2 outward_normal(const Ellipse& ellipse, const Vec2& place_px) {
  const Eigen::Rotation2Dd turn(ellipse.angle_rad);
  const Vec2 own = turn.inverse() * (place_px - ellipse.centre);
  return turn * Vec2(own.x() / (ellipse.major_semi * ellipse.major_semi),
                     own.y() / (ellipse.minor_semi * ellipse.minor_semi))
                    .normalized();
}

EdgePoint edge_point(const Ellipse& ellipse, const Vec2& place_px) {
  return {.place_px = place_px,
          .normal = outward_normal(ellipse, place_px),
          .distance_px = ellipse.distance(place_px)};
}

std::vector<Vec2> even_edge(std::span<const Vec2> edge_px, const Ellipse& ellipse, const Shifts& shifts) {
  std::vector<Vec2> even;
  even.reserve(edge_px.size());
  for (const Vec2& p : edge_px) {
    const EdgePoint point = edge_point(ellipse, p);
    even.push_back(p - put_out(point, shifts) * point.normal);
  }
  return even;
}

template <class Use>
void for_each_edge(const Pictures& pictures, const Use& use) {
  for (const std::vector<Ring>* picture : pictures) {
    for (const Ring& ring : *picture) {
      use(ring.outer_edge, ring.outer);
      use(ring.inner_edge, ring.inner);
    }
  }
}

/// All edge points, with their distances from the ellipses through the corrected ones.
std::vector<EdgePoint> edge_points_of(const Pictures& pictures, const Shifts& shifts) {
  std::vector<EdgePoint> points;
  for_each_edge(pictures, [&](const std::vector<Vec2>& edge_px, const Ellipse& raw) {
    const std::optional<Ellipse> ellipse = fit_ellipse(even_edge(edge_px, raw, shifts));
    if (!ellipse) return;
    for (std::size_t i = 0; i < edge_px.size(); i += k_point_step)
      points.push_back(edge_point(*ellipse, edge_px[i]));
  });
  return points;
}

/// Normal equations with k_span - 1 neighbours to either side, solved by Cholesky's square-root-free form.
class BandedSystem {
 public:
  BandedSystem(std::size_t size, double ridge) : rows_(size), right_(size, 0.0) {
    for (auto& row : rows_) row[0] = ridge;
  }
  void add(const Reach& reach, const EdgePoint& point, int axis, double target) {
    for (std::size_t i = 0; i < Reach::k_span; ++i) {
      if (reach.share[i] == 0) continue;
      const auto row = static_cast<std::size_t>(reach.first) + i;
      const double weighted = k_point_weight * reach.share[i] * point.normal[axis];
      right_[row] += weighted * target;
      for (std::size_t k = i; k < Reach::k_span; ++k)
        rows_[row][k - i] += weighted * reach.share[k] * point.normal[axis];
    }
  }
  [[nodiscard]] double weight(std::size_t row) const { return rows_[row][0]; }
  [[nodiscard]] std::vector<double> solve() && {
    const std::size_t n = rows_.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 1; k < Reach::k_span && i + k < n; ++k) {
        const double ratio = rows_[i][k] / rows_[i][0];
        for (std::size_t j = k; j < Reach::k_span && i + j < n; ++j)
          rows_[i + k][j - k] -= ratio * rows_[i][j];
        right_[i + k] -= ratio * right_[i];
      }
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = 1; k < Reach::k_span && i + k < n; ++k) right_[i] -= rows_[i][k] * right_[i + k];
      right_[i] /= rows_[i][0];
    }
    return std::move(right_);
  }

 private:
  std::vector<std::array<double, Reach::k_span>> rows_;
  std::vector<double> right_;
};

/// Takes off the weighted Gaussian mean round each place.
std::vector<double> fine_part(const std::vector<double>& shifts, const std::vector<double>& weights) {
  const int n = static_cast<int>(shifts.size()), reach = static_cast<int>(3 * k_fine_px);
  std::vector<double> fine(shifts.size());
  for (int i = 0; i < n; ++i) {
    double sum = 0, weight_sum = 0;
    for (int k = std::max(0, i - reach); k <= std::min(n - 1, i + reach); ++k) {
      const double w =
          weights[static_cast<std::size_t>(k)] * std::exp(-0.5 * std::pow((k - i) / k_fine_px, 2));
      sum += w * shifts[static_cast<std::size_t>(k)];
      weight_sum += w;
    }
    fine[static_cast<std::size_t>(i)] = shifts[static_cast<std::size_t>(i)] - sum / weight_sum;
  }
  return fine;
}

/// The shifts along one axis from what the other's leave.
void improve_axis(std::span<const EdgePoint> points, int axis, Shifts& shifts) {
  std::vector<double>& own = shifts[static_cast<std::size_t>(axis)];
  constexpr double k_ridge = (k_edge_sigma_px / k_shift_sigma_px) * (k_edge_sigma_px / k_shift_sigma_px);
  BandedSystem system(own.size(), k_ridge);
  for (const EdgePoint& p : points) {
    const Reach reach(p, axis);
    if (!reach.within(own)) continue;
    const double others =
        p.normal[1 - axis] * Reach(p, 1 - axis).mean(shifts[static_cast<std::size_t>(1 - axis)]);
    system.add(reach, p, axis, p.distance_px - others);
  }
  std::vector<double> weights(own.size());
  // A place that edges saw once counts as half of one that they saw often: nothing tears at the border.
  for (std::size_t i = 0; i < own.size(); ++i) weights[i] = system.weight(i) / (1 + system.weight(i));
  own = fine_part(std::move(system).solve(), weights);
}

Shifts find_shifts(const Pictures& pictures, std::array<std::size_t, 2> size) {
  Shifts shifts{std::vector<double>(size[0], 0.0), std::vector<double>(size[1], 0.0)};
  for (int round = 0; round < k_grid_rounds; ++round) {
    const std::vector<EdgePoint> points = edge_points_of(pictures, shifts);
    for (int sweep = 0; sweep < k_sweeps; ++sweep) {
      for (int axis = 0; axis < 2; ++axis) improve_axis(points, axis, shifts);
    }
  }
  return shifts;
}

/// Of the squared distances of edges from their ellipses, the share that the shifts take off.
double explained_by(const Shifts& shifts, const Pictures& pictures) {
  double before = 0, after = 0;
  for_each_edge(pictures, [&](const std::vector<Vec2>& edge_px, const Ellipse& raw) {
    const std::vector<Vec2> even = even_edge(edge_px, raw, shifts);
    const std::optional<Ellipse> ellipse = fit_ellipse(even);
    if (!ellipse) return;
    for (const Vec2& p : edge_px) before += std::pow(raw.distance(p), 2);
    for (const Vec2& p : even) after += std::pow(ellipse->distance(p), 2);
  });
  return before > 0 ? 1 - after / before : 0;
}

/// Columns and rows that hold edges, and a margin.
std::array<std::size_t, 2> grid_size(const Pictures& pictures) {
  Vec2 farthest = Vec2::Zero();
  for_each_edge(pictures, [&](const std::vector<Vec2>& edge_px, const Ellipse&) {
    for (const Vec2& p : edge_px) farthest = farthest.cwiseMax(p);
  });
  return {static_cast<std::size_t>(farthest.x()) + Reach::k_span,
          static_cast<std::size_t>(farthest.y()) + Reach::k_span};
}

}  // namespace

PixelGrid find_pixel_grid(std::span<const std::vector<Ring>> pictures) {
  PixelGrid grid;
  Pictures all, even, odd;
  for (const std::vector<Ring>& picture : pictures) {
    (all.size() % 2 == 0 ? even : odd).push_back(&picture);
    all.push_back(&picture);
  }
  if (odd.empty()) return grid;
  const std::array<std::size_t, 2> size = grid_size(all);
  grid.explained_ratio_ =
      std::min(explained_by(find_shifts(even, size), odd), explained_by(find_shifts(odd, size), even));
  if (grid.explained_ratio_ < k_least_explained_ratio) return grid;
  grid.shift_px_ = find_shifts(all, size);
  double sum_px2 = 0, count = 0;
  for (const EdgePoint& p : edge_points_of(all, grid.shift_px_)) {
    for (int axis = 0; axis < 2; ++axis)
      sum_px2 += std::pow(Reach(p, axis).mean(grid.shift_px_[static_cast<std::size_t>(axis)]), 2) / 2;
    count += 1;
  }
  grid.rms_px_ = count > 0 ? std::sqrt(sum_px2 / count) : 0;
  return grid;
}

Ring PixelGrid::corrected(const Ring& ring) const {
  if (!uneven()) return ring;
  const auto slanted = [](const Ellipse& ellipse, const std::vector<Vec2>& edge_px) {
    std::vector<Vec2> kept;
    for (const Vec2& p : edge_px) {
      if (outward_normal(ellipse, p).cwiseAbs().minCoeff() > std::sin(k_least_slant_rad)) kept.push_back(p);
    }
    return kept;
  };
  Ring result = ring;
  result.outer_edge = even_edge(slanted(ring.outer, ring.outer_edge), ring.outer, shift_px_);
  result.inner_edge = even_edge(slanted(ring.inner, ring.inner_edge), ring.inner, shift_px_);
  const std::optional<Ellipse> outer = fit_ellipse(result.outer_edge), inner = fit_ellipse(result.inner_edge);
  if (!outer || !inner) return ring;
  const std::optional<ConcentricCentre> centre = concentric_centre(*outer, *inner);
  if (!centre) return ring;
  result.outer = *outer;
  result.inner = *inner;
  result.centre_px = centre->centre;
  result.diameter_ratio = centre->diameter_ratio;
  return result;
}

}  // namespace biteline::calibration
