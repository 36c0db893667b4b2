// SPDX-License-Identifier: MIT
#include "host/bite_line/side/outer_layer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <span>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

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

/// Rows of one height.
struct Raster {
  std::size_t rows;
  float z_low_mm;
  float per_row;

  Raster(const OuterLayerConfig& config, double height_mm)
      : rows{static_cast<std::size_t>(config.height_mm / height_mm) + 1},
        z_low_mm{static_cast<float>(config.z_low_mm)},
        per_row{static_cast<float>(1 / height_mm)} {}
  /// `rows`: the place lies outside.
  [[nodiscard]] std::size_t row_of(float z_mm) const {
    const float row = (z_mm - z_low_mm) * per_row;
    return row < 0 || row >= static_cast<float>(rows) ? rows : static_cast<std::uint32_t>(row);
  }
};

/// What one column keeps.  Its memory serves one column after the other.
class ColumnSieve {
 public:
  ColumnSieve(const Raster& coarse, const Raster& thin, int gap_bins, float depth_mm)
      : coarse_{coarse},
        thin_{thin},
        gap_bins_{gap_bins},
        depth_mm_{depth_mm},
        counts_(coarse.rows * k_layer_bins),
        layers_(coarse.rows) {}

  /// Drops what lies behind the outermost layer, then what is deeper than the outermost o of the fine rows
  /// about it, which leave out a twentieth of their points as strays.
  void keep_outer_layer(std::span<const std::uint32_t> column, const Raster& fine,
                        std::span<OutlinePlace> places) {
    read(column, places);
    find_layers();
    keep_layers(fine, places);
    drop_behind_envelope(places);
  }

 private:
  struct Point {
    std::uint32_t index;
    std::uint32_t row;  ///< of the coarse raster, then of the fine one
    std::uint32_t bin;  ///< of o
    float o_mm;
    float z_mm;
  };
  /// Of a coarse cell.
  struct Layer {
    float innermost_mm;  ///< the innermost o that still belongs to the outermost layer
    std::uint32_t points;
  };
  // The two largest per row; with many points in a row the second one stands for it.
  struct Outermost {
    float first{k_nothing};
    float second{k_nothing};
    std::uint32_t points{0};
    [[nodiscard]] float top() const { return points >= k_many ? second : first; }
  };

  void read(std::span<const std::uint32_t> column, std::span<OutlinePlace> places) {
    std::fill(counts_.begin(), counts_.end(), std::uint8_t{0});
    points_.resize(column.size());
    // Copies, since what is written below could otherwise be these.
    const Raster coarse = coarse_;
    std::uint8_t* const counts = counts_.data();
    Point* next = points_.data();
    for (const std::uint32_t i : column) {
      OutlinePlace& place = places[i];
      const std::size_t row = coarse.row_of(place.z_mm);
      if (row == coarse.rows) {
        place.s_mm = -1.0F;
        continue;
      }
      const std::uint32_t bin = bin_of(place.o_mm);
      *next++ = {i, static_cast<std::uint32_t>(row), bin, place.o_mm, place.z_mm};
      std::uint8_t& count = counts[row * k_layer_bins + bin];
      if (count < k_full) ++count;
    }
    points_.resize(static_cast<std::size_t>(next - points_.data()));
  }

  void find_layers() {
    for (std::size_t row = 0; row < layers_.size(); ++row) {
      const std::span<const std::uint8_t> counts{counts_.data() + row * k_layer_bins, k_layer_bins};
      const std::uint32_t total = std::accumulate(counts.begin(), counts.end(), std::uint32_t{0});
      layers_[row] = {innermost_of_outermost(counts, total, gap_bins_), total};
    }
  }

  void keep_layers(const Raster fine, std::span<OutlinePlace> places) {
    outermost_.assign(fine.rows, {});
    own_top_mm_.assign(thin_.rows + 1, k_nothing);
    const Raster thin = thin_;
    Point* next = points_.data();
    for (const Point& point : points_) {
      const std::size_t at = fine.row_of(point.z_mm);
      if (at == fine.rows || point.o_mm < layers_[point.row].innermost_mm || stray(point)) {
        places[point.index].s_mm = -1.0F;
        continue;
      }
      const float o_mm = point.o_mm;
      float& top_mm = own_top_mm_[thin.row_of(point.z_mm)];
      top_mm = std::max(top_mm, o_mm);
      Outermost& row = outermost_[at];
      ++row.points;
      row.second = std::max(row.second, std::min(row.first, o_mm));
      row.first = std::max(row.first, o_mm);
      *next = point;
      next++->row = static_cast<std::uint32_t>(at);
    }
    points_.resize(static_cast<std::size_t>(next - points_.data()));
  }

  void drop_behind_envelope(std::span<OutlinePlace> places) {
    const std::size_t rows = outermost_.size();
    floor_.resize(rows);
    for (std::size_t row = 0; row < rows; ++row) {
      float lowest = -k_nothing;
      for (std::size_t r = std::max<std::size_t>(row, 1) - 1; r <= std::min(rows - 1, row + 1); ++r) {
        if (outermost_[r].points > 0) lowest = std::min(lowest, outermost_[r].top());
      }
      floor_[row] = lowest - depth_mm_;
    }
    for (const Point& point : points_) {
      if (point.o_mm >= floor_[point.row]) continue;
      float& s_mm = places[point.index].s_mm;
      const float own_top_mm = own_top_mm_[thin_.row_of(point.z_mm)];
      const bool hollow =
          point.o_mm >= floor_[point.row] - k_hollow_mm && point.o_mm >= own_top_mm - depth_mm_;
      s_mm = hollow ? -2 - s_mm : -1.0F;
    }
  }

  /// Hardly any company at its own depth, in a cell with many points.
  [[nodiscard]] bool stray(const Point& point) const {
    const std::uint8_t* counts = counts_.data() + point.row * k_layer_bins;
    const std::uint32_t bin = point.bin;
    std::uint32_t near = counts[bin];
    if (near > 2) return false;
    if (bin > 0) near += counts[bin - 1];
    if (bin + 1 < k_layer_bins) near += counts[bin + 1];
    return near <= 2 && layers_[point.row].points >= 15;
  }

  static std::uint32_t bin_of(float o_mm) {
    const float bin = (o_mm + k_inner_mm) / k_layer_o_mm;
    return static_cast<std::uint32_t>(std::min(std::max(bin, 0.0F), k_layer_bins - 1.0F));
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
  static constexpr float k_nothing = -1.0e6F;
  static constexpr std::uint32_t k_many = 20;
  const Raster& coarse_;
  const Raster& thin_;
  int gap_bins_;
  float depth_mm_;
  std::vector<std::uint8_t> counts_;  ///< per coarse row and bin of o
  std::vector<Layer> layers_;         ///< per coarse row
  std::vector<Point> points_;         ///< those that are left
  std::vector<Outermost> outermost_;  ///< per fine row
  std::vector<float> floor_;
  std::vector<float> own_top_mm_;  ///< per thin row
};

/// Hardly a row of the column is empty between two that are not: profiles lie apart, and are dense along
/// themselves.
bool dense_in_height(std::span<const std::uint32_t> column, std::span<const OutlinePlace> places,
                     const Raster& raster) {
  constexpr std::size_t k_most_holes_of = 50;
  std::vector<std::uint8_t> points(raster.rows, 0);
  for (const std::uint32_t i : column) {
    const std::size_t row = raster.row_of(places[i].z_mm);
    if (row < raster.rows) points[row] = 1;
  }
  std::size_t holes = 0;
  for (std::size_t row = 1; row + 1 < raster.rows; ++row)
    holes += points[row - 1] != 0 && points[row] == 0 && points[row + 1] != 0 ? 1U : 0U;
  return holes * k_most_holes_of <= static_cast<std::size_t>(std::count(points.begin(), points.end(), 1));
}

}  // namespace

Buckets keep_outer_layer(std::span<OutlinePlace> places, const OuterLayerConfig& config) {
  const std::size_t reachable = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>{0, places.size(), 16384}, std::size_t{0},
      [&](const auto& range, std::size_t count) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) count += places[i].s_mm >= 0 ? 1U : 0U;
        return count;
      },
      std::plus<>{});
  const double points_per_mm2 =
      std::max(static_cast<double>(reachable) / (config.length_mm * config.height_mm), 1e-3);
  const double grow =
      std::clamp(std::sqrt(k_layer_points / (k_layer_s_mm * k_layer_z_mm * points_per_mm2)), 1.0, 3.0);
  const int cols = std::max(3, static_cast<int>(config.length_mm / (k_layer_s_mm * grow)));
  const auto per_s = static_cast<float>(cols / config.length_mm);
  Buckets buckets{places.size(), static_cast<std::size_t>(cols), [&](std::size_t i) {
                    const float s_mm = places[i].s_mm;
                    return s_mm < 0 ? -1 : std::min(cols - 1, static_cast<int>(s_mm * per_s));
                  }};
  const Raster coarse{config, k_layer_z_mm * grow};
  const Raster fine{config, k_fine_z_mm};
  const Raster higher{config, k_fine_z_mm * grow};
  const double points_per_mm = points_per_mm2 * config.length_mm / static_cast<double>(cols);
  const Raster lower{config, std::clamp(k_row_points / points_per_mm, k_fine_z_mm, k_fine_z_mm * grow)};
  const int gap_bins =
      std::max(1, static_cast<int>(std::lround(config.gap_mm / static_cast<double>(k_layer_o_mm))));
  const bool high = grow > k_high_rows;
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, buckets.size(), 8}, [&](const auto& range) {
    ColumnSieve sieve{coarse, fine, gap_bins, static_cast<float>(config.depth_mm)};
    for (std::size_t col = range.begin(); col != range.end(); ++col) {
      const bool dense = high && dense_in_height(buckets[col], places, fine);
      sieve.keep_outer_layer(buckets[col], dense ? fine : high ? lower : higher, places);
    }
  });
  return buckets;
}

}  // namespace biteline::bite_line
