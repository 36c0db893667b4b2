// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/raster.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace biteline::bite_line {

namespace {

/// The points of one cell: how many, and their mean place from its middle, in cells.
struct CellMean {
  float count{0}, x{0}, z{0}, o{0};
};

std::vector<CellMean> means_of(const Raster& raster, std::span<const OutlinePlace> places) {
  std::vector<CellMean> means(raster.size());
  const auto per_col = static_cast<float>(1 / raster.col_mm);
  const auto per_row = static_cast<float>(1 / Raster::k_cell_mm);
  for (const OutlinePlace& place : places) {
    if (place.s_mm < 0) continue;
    const float x = place.s_mm * per_col;
    const float z = (place.z_mm - static_cast<float>(raster.z_low_mm)) * per_row;
    if (z < 0 || z >= static_cast<float>(raster.rows)) continue;
    const int col = std::min(static_cast<int>(x), raster.cols - 1);
    const int row = static_cast<int>(z);
    CellMean& mean = means[raster.at(row, col)];
    mean.count += 1;
    mean.x += x - static_cast<float>(col) - 0.5F;
    mean.z += z - static_cast<float>(row) - 0.5F;
    mean.o += place.o_mm;
  }
  for (CellMean& mean : means) {
    if (mean.count == 0) continue;
    mean.x /= mean.count;
    mean.z /= mean.count;
    mean.o /= mean.count;
  }
  return means;
}

/// Weighted sums over the cells about one.
struct PlaneSums {
  float w{0}, x{0}, z{0}, o{0}, xx{0}, xz{0}, zz{0}, xo{0}, zo{0};

  void add(float weight, float x_cells, float z_cells, float o_mm) {
    w += weight;
    x += weight * x_cells;
    z += weight * z_cells;
    o += weight * o_mm;
    xx += weight * x_cells * x_cells;
    xz += weight * x_cells * z_cells;
    zz += weight * z_cells * z_cells;
    xo += weight * x_cells * o_mm;
    zo += weight * z_cells * o_mm;
  }
};

/// Gaussian weights to both sides, in whole cells.
std::vector<float> weights_of(double sigma_cells) {
  const int reach = static_cast<int>(std::ceil(2.5 * sigma_cells));
  std::vector<float> weights;
  for (int j = -reach; j <= reach; ++j)
    weights.push_back(static_cast<float>(std::exp(-0.5 * j * j / (sigma_cells * sigma_cells))));
  return weights;
}

/// How far apart profiles are, in cells along the outline: four fifths of it have points as near as that.
double apart_cells(const Raster& raster, std::span<const CellMean> means) {
  constexpr std::size_t k_most = 6;  // what is farther apart is a gap in the surface
  std::array<std::size_t, k_most + 1> length{};
  for (int row = 0; row < raster.rows; ++row) {
    std::size_t since = k_most + 1;
    for (int col = 0; col < raster.cols; ++col, ++since) {
      if (means[raster.at(row, col)].count == 0) continue;
      if (since <= k_most) length[since] += since;
      since = 0;
    }
  }
  const std::size_t all = std::accumulate(length.begin(), length.end(), std::size_t{0});
  std::size_t apart = 0, sum = 0;
  while (apart < k_most && 5 * sum <= 4 * all) sum += length[++apart];
  return static_cast<double>(apart);
}

/// Gaussian weights along the outline and up.
struct PlaneWeights {
  std::vector<float> along, up;
};

class PlaneFit {
 public:
  PlaneFit(Raster& raster, std::span<const CellMean> means, const PlaneWeights& weights, double along_per_up)
      : raster_{raster},
        means_{means},
        weights_{weights},
        up_per_along_{static_cast<float>(1 / along_per_up)},
        reach_cols_{static_cast<int>(weights.along.size() / 2)},
        reach_rows_{static_cast<int>(weights.up.size() / 2)} {}

  void column(int col) {
    for (int row = 0; row < raster_.rows; ++row) fit(row, col);
  }

 private:
  [[nodiscard]] PlaneSums sums_about(int row, int col) const {
    PlaneSums sums;
    const int first = std::max(-reach_rows_, -row);
    const int last = std::min(reach_rows_, raster_.rows - 1 - row);
    for (int dc = -reach_cols_; dc <= reach_cols_; ++dc) {
      const float along = weights_.along[static_cast<std::size_t>(dc + reach_cols_)];
      const CellMean* column = means_.data() + raster_.at(row, raster_.round_col(col + dc));
      for (int dr = first; dr <= last; ++dr) {
        const CellMean& mean = column[dr];
        if (mean.count == 0) continue;
        sums.add(along * weights_.up[static_cast<std::size_t>(dr + reach_rows_)] * mean.count,
                 mean.x + static_cast<float>(dc), mean.z + static_cast<float>(dr), mean.o);
      }
    }
    return sums;
  }

  void fit(int row, int col) {
    constexpr float k_least_weight = 1.5F;
    constexpr float k_least_spread = 0.02F;  // squared: hardly a slope is known of what lies closer together
    constexpr float k_farthest = 0.8F;  // their mean, from the middle: what lies there only is beyond an edge
    const std::size_t cell = raster_.at(row, col);
    raster_.seen[cell] = 0;
    raster_.o_mm[cell] = raster_.along_ratio[cell] = raster_.up_ratio[cell] = 0;
    const PlaneSums sums = sums_about(row, col);
    if (sums.w < k_least_weight) return;
    const float x = sums.x / sums.w, z = sums.z / sums.w, o = sums.o / sums.w;
    const float x_away = x * up_per_along_;
    if (x_away * x_away + z * z > k_farthest * k_farthest) return;
    const float xx = sums.xx / sums.w - x * x + k_least_spread;
    const float zz = sums.zz / sums.w - z * z + k_least_spread;
    const float xz = sums.xz / sums.w - x * z;
    const float xo = sums.xo / sums.w - x * o;
    const float zo = sums.zo / sums.w - z * o;
    const float area = xx * zz - xz * xz;
    const float along = (xo * zz - zo * xz) / area;
    const float up = (zo * xx - xo * xz) / area;
    raster_.seen[cell] = 1;
    raster_.o_mm[cell] = o - along * x - up * z;
    raster_.along_ratio[cell] = along / static_cast<float>(raster_.col_mm);
    raster_.up_ratio[cell] = up / static_cast<float>(Raster::k_cell_mm);
  }

  Raster& raster_;
  std::span<const CellMean> means_;
  const PlaneWeights& weights_;
  float up_per_along_;
  int reach_cols_, reach_rows_;
};

}  // namespace

Raster Raster::of(std::span<const OutlinePlace> places, double turn_mm, double z_low_mm, double height_mm,
                  double points_per_mm2) {
  constexpr double k_sigma_mm = 0.55;        // close to the 0.4 mm of the line's definition
  constexpr double k_least_points = 3;       // within a circle of that radius, where points are few
  constexpr double k_sigma_of_apart = 0.45;  // midway between two profiles, both count by a half
  constexpr double k_fewest_per_mm2 = 0.2;   // fewer show no shoe
  Raster raster;
  raster.z_low_mm = z_low_mm;
  raster.rows = std::max(1, static_cast<int>(height_mm / k_cell_mm));
  raster.cols = std::max(1, static_cast<int>(std::lround(turn_mm / k_cell_mm)));
  raster.col_mm = turn_mm / raster.cols;
  for (PooledVector<float>* values : {&raster.o_mm, &raster.along_ratio, &raster.up_ratio})
    values->resize(raster.size());
  raster.seen.resize(raster.size());
  const double few_mm =
      std::sqrt(k_least_points / (std::numbers::pi * std::max(points_per_mm2, k_fewest_per_mm2)));
  const std::vector<CellMean> means = means_of(raster, places);
  const double up = std::max(k_sigma_mm, few_mm) / k_cell_mm;
  const double along = std::max(up, k_sigma_of_apart * apart_cells(raster, means));
  const PlaneWeights weights{.along = weights_of(along), .up = weights_of(up)};
  PlaneFit fit{raster, means, weights, along / up};
  tbb::parallel_for(tbb::blocked_range<int>{0, raster.cols, 16}, [&](const auto& range) {
    for (int col = range.begin(); col != range.end(); ++col) fit.column(col);
  });
  return raster;
}

}  // namespace biteline::bite_line
