// SPDX-License-Identifier: MIT
#include "host/bite_line/side/side_field.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/bite_line/side/outer_layer.hpp"
#include "host/bite_line/simd_kernels.hpp"

namespace biteline::bite_line {

namespace {

constexpr float k_outer_mm = 16.0F;  // and how far outside

PooledVector<OutlinePlace> locate_all(std::span<const Eigen::Vector3f> points, const Outline& outline) {
  PooledVector<OutlinePlace> places(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, points.size(), 8192}, [&](const auto& range) {
    const std::span located{places.data() + range.begin(), range.size()};
    outline.locate(points.subspan(range.begin(), range.size()), located);
    for (OutlinePlace& place : located) {
      if (place.o_mm <= -k_inner_mm || place.o_mm >= k_outer_mm) place.s_mm = -1.0F;
    }
  });
  return places;
}

/// Sums over the points of each cell, column after column: of 1, of their z offsets from its middle in rows,
/// of o, of both times each other.  Each sum of a column lies between `margin` rows without points.
struct Sums {
  enum Sum : std::size_t { k_w, k_z, k_o, k_zo, k_sums };
  std::size_t rows, margin;
  PooledVector<float> values;
  std::size_t points{0};

  [[nodiscard]] std::size_t height() const { return rows + 2 * margin; }
  [[nodiscard]] float* of(std::size_t col, std::size_t sum = 0) {
    return values.data() + (col * k_sums + sum) * height();
  }
};

/// `columns` are wider than the grid's, so two that are not neighbours share no cell of it.
Sums collect(std::span<const OutlinePlace> places, const Buckets& columns, const SideGrid& grid,
             std::size_t margin) {
  const auto cols = static_cast<std::size_t>(grid.cols);
  Sums sums{.rows = static_cast<std::size_t>(grid.rows), .margin = margin, .values = {}};
  sums.values.resize(cols * Sums::k_sums * sums.height());
  tbb::parallel_for(std::size_t{0}, cols,
                    [&](std::size_t col) { std::fill_n(sums.of(col), Sums::k_sums * sums.height(), 0.0F); });
  const auto z_low_mm = static_cast<float>(grid.z_low_mm);
  const auto per_row = static_cast<float>(1 / grid.row_mm);
  const auto per_col = static_cast<float>(1 / grid.col_mm);
  std::atomic<std::size_t> points{0};
  const auto add_column = [&](std::size_t column) {
    std::size_t used = 0;
    for (const std::uint32_t i : columns[column]) {
      const OutlinePlace& place = places[i];
      if (place.s_mm < 0) continue;
      const float z = (place.z_mm - z_low_mm) * per_row;
      const std::size_t row = static_cast<std::uint32_t>(z);
      if (row >= sums.rows) continue;
      const float dz = z - static_cast<float>(row) - 0.5F;
      float* cell =
          sums.of(std::min<std::size_t>(cols - 1, static_cast<std::uint32_t>(place.s_mm * per_col))) +
          margin + row;
      cell[Sums::k_w * sums.height()] += 1.0F;
      cell[Sums::k_z * sums.height()] += dz;
      cell[Sums::k_o * sums.height()] += place.o_mm;
      cell[Sums::k_zo * sums.height()] += place.o_mm * dz;
      ++used;
    }
    points += used;
  };
  for (const std::size_t first : {0U, 1U})
    tbb::parallel_for(first, columns.size(), std::size_t{2}, add_column);
  sums.points = points;
  return sums;
}

/// Change of the angle of the section's tangent against upright, from `reach` rows below to as many above.
void turn_of_column(std::span<const float> o, const std::uint8_t* seen, double reach_mm, double row_mm,
                    std::vector<float>& angle, float* turn) {
  const auto reach = static_cast<std::size_t>(std::max(1L, std::lround(reach_mm / row_mm)));
  std::fill_n(turn, o.size(), 0.0F);
  if (2 * reach >= o.size()) return;
  angle.resize(o.size() - reach);  // from each row to the one `reach` above
  slope_angles(angle, o.data(), o.data() + reach,
               static_cast<float>(1.0 / (static_cast<double>(reach) * row_mm)));
  for (std::size_t r = reach; r < angle.size(); ++r)
    turn[r] = (seen[r - reach] & seen[r] & seen[r + reach]) != 0 ? angle[r] - angle[r - reach] : 0.0F;
}

/// o(s, z) by Gaussian weights along the outline (`along`) and a local straight line in z, evaluated at each
/// cell's middle (`up`: its weights): unlike a plain weighted mean it is right on slopes with uneven density
/// and at borders.  Then its turns.
void fit_columns(Sums& sums, std::span<const float> along, std::span<const float> up,
                 const SideField::Config& config, SideField& field) {
  constexpr float k_least_spread_rows2 = 0.02F;
  const SideGrid& grid = field.grid;
  const auto cols = static_cast<std::size_t>(grid.cols);
  const double sigma_cols = config.sigma_s_mm / grid.col_mm;
  const double sigma_rows = config.sigma_z_mm / grid.row_mm;
  // A place counts as seen with at least two points' worth of weight, and a twentieth of what is usual in
  // this cloud.
  const double usual = static_cast<double>(sums.points) / static_cast<double>(grid.size()) * 2 * 3.14159 *
                       sigma_cols * sigma_rows;
  const LineFit fit{static_cast<float>(std::max(1.5, 0.05 * usual)), k_least_spread_rows2};
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, cols, 8}, [&](const auto& range) {
    std::vector<float> blurred(Sums::k_sums * sums.height());
    std::vector<float> angle;
    std::vector<WeightedRow> taps(along.size());
    std::vector<RowOfSums> rows;
    const std::size_t reach = up.size() / 2;
    for (std::size_t j = 0; j < up.size(); ++j) {
      const auto of = [&](Sums::Sum sum) { return blurred.data() + sum * sums.height() + j; };
      rows.push_back({of(Sums::k_w), of(Sums::k_z), of(Sums::k_o), of(Sums::k_zo), up[j],
                      static_cast<float>(j) - static_cast<float>(reach)});
    }
    for (std::size_t col = range.begin(); col != range.end(); ++col) {
      for (std::size_t j = 0; j < taps.size(); ++j) {
        const float* other = sums.of((col + j + along.size() * cols - along.size() / 2) % cols);
        taps[j] = {other, along[j]};
      }
      sum_rows(blurred, taps);
      const std::size_t first = grid.at(0, static_cast<int>(col));
      const std::span o{field.o_mm.data() + first, sums.rows};
      std::uint8_t* seen = field.seen.data() + first;
      fit_rows(rows, fit, o, seen);
      turn_of_column(o, seen, SideField::k_turn_reach_mm, grid.row_mm, angle, field.turn_rad.data() + first);
      turn_of_column(o, seen, 2 * SideField::k_turn_reach_mm, grid.row_mm, angle,
                     field.wide_turn_rad.data() + first);
    }
  });
}

}  // namespace

SideField SideField::build(const Shoe& shoe, const Outline& outline, const Config& config) {
  SideField field;
  SideGrid& grid = field.grid;
  grid.row_mm = config.row_mm;
  grid.z_low_mm = static_cast<double>(shoe.box.min().z());
  const double height_mm = std::min(config.top_mm, static_cast<double>(shoe.box.sizes().z()));
  grid.rows = std::max(16, static_cast<int>(height_mm / config.row_mm) + 1);
  grid.cols = static_cast<int>(outline.length_mm() / config.col_mm);
  grid.col_mm = outline.length_mm() / grid.cols;

  field.places = locate_all(shoe.points, outline);
  const Buckets columns = keep_outer_layer(field.places, {.length_mm = outline.length_mm(),
                                                          .z_low_mm = grid.z_low_mm,
                                                          .height_mm = grid.rows * grid.row_mm,
                                                          .gap_mm = config.lining_gap_mm});
  const std::vector<float> along = gaussian(config.sigma_s_mm / grid.col_mm, 3);
  const std::vector<float> up = gaussian(config.sigma_z_mm / grid.row_mm, 3);
  Sums sums = collect(field.places, columns, grid, up.size() / 2);
  for (PooledVector<float>* values : {&field.o_mm, &field.turn_rad, &field.wide_turn_rad})
    values->resize(grid.size());
  field.seen.resize(grid.size());
  fit_columns(sums, along, up, config, field);
  const auto seen = static_cast<double>(std::count(field.seen.begin(), field.seen.end(), 1));
  field.points_per_mm2 = static_cast<double>(sums.points) / std::max(1.0, seen * grid.row_mm * grid.col_mm);
  return field;
}

}  // namespace biteline::bite_line
