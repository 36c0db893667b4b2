// SPDX-License-Identifier: MIT
#include "host/bite_line/side/outer_layer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include <tbb/parallel_for.h>

namespace biteline::bite_line {

namespace {

// Coarse cells in which layers are told apart: 2 mm along and 1 mm up, or larger where points are few.
constexpr double k_layer_s_mm = 2.0;
constexpr double k_layer_z_mm = 1.0;
constexpr double k_layer_points = 20.0;
constexpr double k_fine_z_mm = 0.33;  // of the envelope
// Rows so much higher than that may be as high as a groove, and take its bottom for what lies behind its
// flanks.  Read off scans: one of a real shape has rows of 2.3 and is better with them, made ones from 2.45.
constexpr double k_high_rows = 2.4;
// Then this many points of a column fall into a row where they lie anywhere.
constexpr double k_row_points = 3.0;
constexpr float k_layer_o_mm = 0.75F;
constexpr int k_layer_bins = 80;

/// Columns of one length, with the climb of the surface's edges in each.
struct Columns {
  float width_mm;
  std::vector<float> climb;

  Columns(const OuterLayerConfig& config, std::size_t count)
      : width_mm{static_cast<float>(config.length_mm / static_cast<double>(count))}, climb(count, 0.0F) {
    for (std::size_t col = 0; col < count && !config.climb.empty(); ++col)
      climb[col] = config.climb[(2 * col + 1) * config.climb.size() / (2 * count)];
  }
  /// Height at the column's middle of the edge that runs through a place of it.
  [[nodiscard]] float level_mm(std::size_t col, const OutlinePlace& place) const {
    return place.z_mm - climb[col] * (place.s_mm - (static_cast<float>(col) + 0.5F) * width_mm);
  }
};

/// Rows of one height.
struct Raster {
  std::size_t rows;
  float z_low_mm;
  float per_row;

  Raster(const OuterLayerConfig& config, double height_mm)
      : rows{static_cast<std::size_t>(config.height_mm / height_mm) + 1},
        z_low_mm{static_cast<float>(config.z_low_mm)},
        per_row{static_cast<float>(1 / height_mm)} {}
  /// Of a place whose edge has this level; rows: the place itself lies outside.
  [[nodiscard]] std::size_t row_of(float z_mm, float level_mm) const {
    if (z_mm < z_low_mm || (z_mm - z_low_mm) * per_row >= static_cast<float>(rows)) return rows;
    return std::min(rows - 1, static_cast<std::size_t>(std::max(level_mm - z_low_mm, 0.0F) * per_row));
  }
};

/// The innermost o that still belongs to the outermost layer, per coarse cell, column after column.
class DepthLayers {
 public:
  DepthLayers(std::span<const OutlinePlace> places, const Buckets& buckets, const Columns& columns,
              const OuterLayerConfig& config, double grow)
      : raster_{config, k_layer_z_mm * grow}, columns_{columns} {
    const std::size_t cells = buckets.size() * raster_.rows;
    counts_.assign(cells * k_layer_bins, 0);
    limit_.assign(cells, -k_inner_mm);
    totals_.assign(cells, 0);
    const int gap_bins =
        std::max(1, static_cast<int>(std::lround(config.gap_mm / static_cast<double>(k_layer_o_mm))));
    tbb::parallel_for(std::size_t{0}, buckets.size(), [&](std::size_t col) {
      for (const std::uint32_t i : buckets[col]) {
        const std::size_t row = raster_.row_of(places[i].z_mm, columns_.level_mm(col, places[i]));
        if (row == raster_.rows) continue;
        auto& count = counts_[(col * raster_.rows + row) * k_layer_bins + bin_of(places[i].o_mm)];
        if (count < k_full) ++count;
      }
      for (std::size_t cell = col * raster_.rows; cell < (col + 1) * raster_.rows; ++cell) {
        const std::span<const std::uint8_t> counts{counts_.data() + cell * k_layer_bins, k_layer_bins};
        for (const std::uint8_t count : counts) totals_[cell] += count;
        limit_[cell] = innermost_of_outermost(counts, totals_[cell], gap_bins);
      }
    });
  }

  [[nodiscard]] bool contains(std::size_t col, const OutlinePlace& place) const {
    const std::size_t row = raster_.row_of(place.z_mm, columns_.level_mm(col, place));
    if (row == raster_.rows) return false;
    const std::size_t cell = col * raster_.rows + row;
    return place.o_mm >= limit_[cell] && !stray(cell, place.o_mm);
  }

 private:
  /// Hardly any company at its own depth, in a cell with many points.
  [[nodiscard]] bool stray(std::size_t cell, float o_mm) const {
    const std::uint8_t* counts = counts_.data() + cell * k_layer_bins;
    const std::size_t bin = bin_of(o_mm);
    std::uint32_t near = counts[bin];
    if (near > 2) return false;
    if (bin > 0) near += counts[bin - 1];
    if (bin + 1 < k_layer_bins) near += counts[bin + 1];
    return near <= 2 && totals_[cell] >= 15;
  }

  static std::size_t bin_of(float o_mm) {
    return static_cast<std::size_t>(
        std::clamp((o_mm + k_inner_mm) / k_layer_o_mm, 0.0F, k_layer_bins - 1.0F));
  }

  /// Goes inwards from the outermost bin and stops at the first gap behind a cluster that is more than a
  /// stray point.
  static float innermost_of_outermost(std::span<const std::uint8_t> counts, std::uint32_t total,
                                      int gap_bins) {
    if (total == 0) return -k_inner_mm;
    const std::uint32_t enough = std::clamp<std::uint32_t>(total / 12, 1, 4);
    std::uint32_t cluster = 0;
    int empty = 0;
    int lowest = 0;
    for (int bin = k_layer_bins - 1; bin >= 0; --bin) {
      const std::uint8_t count = counts[static_cast<std::size_t>(bin)];
      if (count > 0) {
        cluster += count;
        lowest = bin;
        empty = 0;
      } else if (cluster > 0 && ++empty >= gap_bins) {
        if (cluster >= enough) break;
        cluster = 0;
      }
    }
    return static_cast<float>(lowest) * k_layer_o_mm - k_inner_mm - 0.01F;
  }

  static constexpr std::uint8_t k_full = 255;  // nothing here asks for more
  Raster raster_;
  const Columns& columns_;
  Large<float> limit_;
  Large<std::uint8_t> counts_;
  Large<std::uint32_t> totals_;
};

/// Drops from a column what lies behind the outermost layer, then what is deeper than the outermost o of the
/// fine rows about it, which leave out a twentieth of their points as strays.
void keep_outer_layer_of(std::size_t col, std::span<const std::uint32_t> column, const Columns& columns,
                         std::span<OutlinePlace> places, const DepthLayers& layers, const Raster& fine,
                         float depth_mm) {
  constexpr float k_nothing = -1.0e6F;
  constexpr std::uint32_t k_many = 20;
  // The two largest per row; with many points in a row the second one stands for it.
  struct Outermost {
    float first{k_nothing};
    float second{k_nothing};
    std::uint32_t points{0};
    [[nodiscard]] float top() const { return points >= k_many ? second : first; }
  };
  struct Kept {
    std::uint32_t index;
    std::uint32_t row;
    float o_mm;
  };
  std::vector<Outermost> outermost(fine.rows);
  std::vector<Kept> kept;
  kept.reserve(column.size());
  for (const std::uint32_t i : column) {
    OutlinePlace& place = places[i];
    const std::size_t at = fine.row_of(place.z_mm, columns.level_mm(col, place));
    if (at == fine.rows || !layers.contains(col, place)) {
      place.s_mm = -1.0F;
      continue;
    }
    kept.push_back({i, static_cast<std::uint32_t>(at), place.o_mm});
    Outermost& row = outermost[at];
    ++row.points;
    row.second = std::max(row.second, std::min(row.first, place.o_mm));
    row.first = std::max(row.first, place.o_mm);
  }
  std::vector<float> floor(fine.rows);
  for (std::size_t row = 0; row < fine.rows; ++row) {
    float lowest = -k_nothing;
    for (std::size_t r = std::max<std::size_t>(row, 1) - 1; r <= std::min(fine.rows - 1, row + 1); ++r) {
      if (outermost[r].points > 0) lowest = std::min(lowest, outermost[r].top());
    }
    floor[row] = lowest - depth_mm;
  }
  for (const Kept& point : kept) {
    if (point.o_mm < floor[point.row]) places[point.index].s_mm = -1.0F;
  }
}

/// Hardly a row of the column is empty between two that are not: profiles lie apart, and are dense along
/// themselves.
bool dense_in_height(std::size_t col, std::span<const std::uint32_t> column, const Columns& columns,
                     std::span<const OutlinePlace> places, const Raster& raster) {
  constexpr std::size_t k_most_holes_of = 50;
  std::vector<std::uint8_t> points(raster.rows, 0);
  for (const std::uint32_t i : column) {
    const std::size_t row = raster.row_of(places[i].z_mm, columns.level_mm(col, places[i]));
    if (row < raster.rows) points[row] = 1;
  }
  std::size_t holes = 0;
  for (std::size_t row = 1; row + 1 < raster.rows; ++row)
    holes += points[row - 1] != 0 && points[row] == 0 && points[row + 1] != 0 ? 1U : 0U;
  return holes * k_most_holes_of <= static_cast<std::size_t>(std::count(points.begin(), points.end(), 1));
}

}  // namespace

Buckets keep_outer_layer(std::span<OutlinePlace> places, const OuterLayerConfig& config) {
  const auto reachable = static_cast<double>(
      std::count_if(places.begin(), places.end(), [](const OutlinePlace& p) { return p.s_mm >= 0; }));
  const double points_per_mm2 = std::max(reachable / (config.length_mm * config.height_mm), 1e-3);
  const double grow =
      std::clamp(std::sqrt(k_layer_points / (k_layer_s_mm * k_layer_z_mm * points_per_mm2)), 1.0, 3.0);
  const int cols = std::max(3, static_cast<int>(config.length_mm / (k_layer_s_mm * grow)));
  const auto per_s = static_cast<float>(cols / config.length_mm);
  Buckets buckets{places.size(), static_cast<std::size_t>(cols), [&](std::size_t i) {
                    const float s_mm = places[i].s_mm;
                    return s_mm < 0 ? -1 : std::min(cols - 1, static_cast<int>(s_mm * per_s));
                  }};
  const Columns columns{config, buckets.size()};
  const DepthLayers layers{places, buckets, columns, config, grow};
  const Raster fine{config, k_fine_z_mm};
  const Raster higher{config, k_fine_z_mm * grow};
  const double points_per_mm = points_per_mm2 * config.length_mm / static_cast<double>(cols);
  const Raster lower{config, std::clamp(k_row_points / points_per_mm, k_fine_z_mm, k_fine_z_mm * grow)};
  tbb::parallel_for(std::size_t{0}, buckets.size(), [&](std::size_t col) {
    const bool high = grow > k_high_rows;
    const bool dense = high && dense_in_height(col, buckets[col], columns, places, fine);
    keep_outer_layer_of(col, buckets[col], columns, places, layers,
                        dense  ? fine
                        : high ? lower
                               : higher,
                        static_cast<float>(config.depth_mm));
  });
  return buckets;
}

}  // namespace biteline::bite_line
