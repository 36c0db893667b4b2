// SPDX-License-Identifier: MIT
#include "host/groove/side/side_field.hpp"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/groove/lanes.hpp"
#include "host/groove/side/outer_layer.hpp"

namespace biteline::groove {

namespace {

constexpr float k_inner_mm = 44.0F;  // how far inside the outline a surface may lie: a toe's top does
constexpr float k_outer_mm = 16.0F;

std::vector<Place> locate_all(std::span<const Eigen::Vector3f> points, const Outline& outline) {
  std::vector<Place> places(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), 8192}, [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Outline::Foot foot = outline.locate(points[i].x(), points[i].y());
      const bool usable = foot.valid && foot.o_mm > -k_inner_mm && foot.o_mm < k_outer_mm;
      places[i] = {usable ? foot.s_mm : -1.0F, foot.o_mm, points[i].z()};
    }
  });
  return places;
}

/// Per cell: weight, sum of z offsets from the cell's middle, sum of o, sum of o times offset.
struct Moments {
  std::vector<float> w, wz, o, oz;
  explicit Moments(std::size_t size) : w(size, 0), wz(size, 0), o(size, 0), oz(size, 0) {}
};

void blur_along(std::vector<float>& field, const SideGrid& grid, double sigma_cols) {
  const int reach = static_cast<int>(std::ceil(3 * sigma_cols));
  std::vector<float> kernel;
  for (int j = -reach; j <= reach; ++j)
    kernel.push_back(static_cast<float>(std::exp(-0.5 * std::pow(j / sigma_cols, 2))));
  tbb::parallel_for(tbb::blocked_range<int>{0, grid.rows, 16}, [&](const auto& range) {
    std::vector<float> padded(static_cast<std::size_t>(grid.cols + 2 * reach));
    for (int row = range.begin(); row != range.end(); ++row) {
      float* line = field.data() + grid.at(row, 0);
      for (int c = 0; c < grid.cols + 2 * reach; ++c)
        padded[static_cast<std::size_t>(c)] = line[((c - reach) % grid.cols + grid.cols) % grid.cols];
      std::fill(line, line + grid.cols, 0.0F);
      for (std::size_t j = 0; j < kernel.size(); ++j)
        add_scaled({line, static_cast<std::size_t>(grid.cols)}, padded.data() + j, kernel[j]);
    }
  });
}

/// Local straight line in z through Gaussian weights, evaluated at each cell's middle: unlike a plain
/// weighted mean it is right on slopes with uneven density and at borders.
void fit_rows(const Moments& m, const SideGrid& grid, double sigma_rows, double min_weight,
              SideField& field) {
  const int reach = static_cast<int>(std::ceil(3 * sigma_rows));
  tbb::parallel_for(tbb::blocked_range<int>{0, grid.rows, 8}, [&](const auto& range) {
    const auto cols = static_cast<std::size_t>(grid.cols);
    std::vector<float> s0(cols), s1(cols), s2(cols), t0(cols), t1(cols), up(cols), down(cols);
    for (int row = range.begin(); row != range.end(); ++row) {
      for (auto* sums : {&s0, &s1, &s2, &t0, &t1, &up, &down}) std::fill(sums->begin(), sums->end(), 0.0F);
      for (int j = -reach; j <= reach; ++j) {
        const int other = row + j;
        if (other < 0 || other >= grid.rows) continue;
        const auto g = static_cast<float>(std::exp(-0.5 * std::pow(j / sigma_rows, 2)));
        const auto d = static_cast<float>(j);
        const std::size_t base = grid.at(other, 0);
        const float* w = m.w.data() + base;
        const float* wz = m.wz.data() + base;
        const float* o = m.o.data() + base;
        add_scaled(s0, w, g);
        add_scaled(s1, w, g * d);
        add_scaled(s1, wz, g);
        add_scaled(s2, w, g * d * d);
        add_scaled(s2, wz, 2 * g * d);
        add_scaled(t0, o, g);
        add_scaled(t1, o, g * d);
        add_scaled(t1, m.oz.data() + base, g);
        if (j != 0) add_scaled(j < 0 ? down : up, w, g);
      }
      for (std::size_t c = 0; c < cols; ++c) {
        const std::size_t cell = grid.at(row, 0) + c;
        if (s0[c] < static_cast<float>(min_weight)) continue;
        const float det = s0[c] * s2[c] - s1[c] * s1[c];
        field.o_mm[cell] =
            det > 0.02F * s0[c] * s0[c] ? (t0[c] * s2[c] - t1[c] * s1[c]) / det : t0[c] / s0[c];
        field.seen[cell] = std::min(up[c], down[c]) > 0.12F * s0[c] ? 1 : 0;
      }
    }
  });
}

/// atan to 1e-5 rad (Abramowitz and Stegun 4.4.49), without a branch, so that it goes through vectors.
inline float arc_tangent(float x) {
  const float size = std::abs(x);
  const float t = size > 1.0F ? 1.0F / size : size;
  const float t2 = t * t;
  const float small =
      t * (0.9998660F + t2 * (-0.3302995F + t2 * (0.1801410F + t2 * (-0.0851330F + t2 * 0.0208351F))));
  const float angle = size > 1.0F ? 1.57079633F - small : small;
  return x < 0.0F ? -angle : angle;
}

/// Change of the angle of the section's tangent against upright, from `reach` rows below to as many above.
void turns(SideField& field, double reach_mm, std::vector<float>& turn) {
  const SideGrid& grid = field.grid;
  const int reach = std::max(1, static_cast<int>(std::lround(reach_mm / grid.row_mm)));
  turn.assign(grid.size(), 0.0F);
  tbb::parallel_for(
      tbb::blocked_range<int>{reach, std::max(reach, grid.rows - reach), 8}, [&](const auto& range) {
        const auto per_span = static_cast<float>(1.0 / (reach * grid.row_mm));
        for (int row = range.begin(); row != range.end(); ++row) {
          const float* low = field.o_mm.data() + grid.at(row - reach, 0);
          const float* mid = field.o_mm.data() + grid.at(row, 0);
          const float* high = field.o_mm.data() + grid.at(row + reach, 0);
          const std::uint8_t* seen_low = field.seen.data() + grid.at(row - reach, 0);
          const std::uint8_t* seen_mid = field.seen.data() + grid.at(row, 0);
          const std::uint8_t* seen_high = field.seen.data() + grid.at(row + reach, 0);
          float* out = turn.data() + grid.at(row, 0);
          for (int c = 0; c < grid.cols; ++c) {
            const float angle =
                arc_tangent((high[c] - mid[c]) * per_span) - arc_tangent((mid[c] - low[c]) * per_span);
            out[c] = (seen_low[c] & seen_mid[c] & seen_high[c]) != 0 ? angle : 0.0F;
          }
        }
      });
}

}  // namespace

SideField SideField::build(std::span<const Eigen::Vector3f> points, const Outline& outline,
                           const Config& config) {
  SideField field;
  float lowest = 1e9F;
  float highest = -1e9F;
  for (const Eigen::Vector3f& p : points) {
    lowest = std::min(lowest, p.z());
    highest = std::max(highest, p.z());
  }
  SideGrid& grid = field.grid;
  grid.row_mm = config.row_mm;
  grid.z_low_mm = static_cast<double>(lowest);
  grid.rows = std::max(
      16,
      static_cast<int>(std::min(config.top_mm, static_cast<double>(highest - lowest)) / config.row_mm) + 1);
  grid.cols = static_cast<int>(outline.length_mm() / config.col_mm);
  grid.col_mm = outline.length_mm() / grid.cols;

  field.places = locate_all(points, outline);
  keep_outer_layer(field.places, {.length_mm = outline.length_mm(),
                                  .z_low_mm = grid.z_low_mm,
                                  .height_mm = grid.rows * grid.row_mm,
                                  .gap_mm = config.lining_gap_mm,
                                  .inner_mm = static_cast<double>(k_inner_mm)});
  Moments moments{grid.size()};
  std::size_t used = 0;
  for (const Place& place : field.places) {
    if (place.s_mm < 0) continue;
    const auto z = static_cast<float>((static_cast<double>(place.z_mm) - grid.z_low_mm) / grid.row_mm);
    const int row = static_cast<int>(z);
    if (row >= grid.rows) continue;
    const int col = static_cast<int>(static_cast<double>(place.s_mm) / grid.col_mm) % grid.cols;
    const std::size_t cell = grid.at(row, col);
    const float dz = z - static_cast<float>(row) - 0.5F;
    moments.w[cell] += 1.0F;
    moments.wz[cell] += dz;
    moments.o[cell] += place.o_mm;
    moments.oz[cell] += place.o_mm * dz;
    ++used;
  }
  for (auto* sums : {&moments.w, &moments.wz, &moments.o, &moments.oz})
    blur_along(*sums, grid, config.sigma_s_mm / grid.col_mm);

  field.o_mm.assign(grid.size(), 0.0F);
  field.seen.assign(grid.size(), 0);
  // A place counts as seen with at least two points' worth of weight, and a twentieth of what is usual in
  // this cloud.
  const double usual = static_cast<double>(used) / static_cast<double>(grid.size()) * 2 * 3.14159 *
                       (config.sigma_s_mm / grid.col_mm) * (config.sigma_z_mm / grid.row_mm);
  fit_rows(moments, grid, config.sigma_z_mm / grid.row_mm, std::max(1.5, 0.05 * usual), field);
  const auto seen = static_cast<double>(std::count(field.seen.begin(), field.seen.end(), 1));
  field.points_per_mm2 = static_cast<double>(used) / std::max(1.0, seen * grid.row_mm * grid.col_mm);
  turns(field, 0.75, field.turn_rad);
  turns(field, 1.5, field.wide_turn_rad);
  return field;
}

}  // namespace biteline::groove
