// SPDX-License-Identifier: MIT
#include "host/groove/side/outer_layer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace biteline::groove {

namespace {

// Coarse cells in which layers are told apart: 2 mm along and 1 mm up, or larger where points are few.
constexpr double k_layer_s_mm = 2.0;
constexpr double k_layer_z_mm = 1.0;
constexpr double k_layer_points = 20.0;
// Fine cells of the envelope: as far along, a third of a millimetre up.
constexpr double k_fine_s_mm = 2.0;
constexpr double k_fine_z_mm = 0.33;
constexpr float k_layer_o_mm = 0.75F;
constexpr float k_inner_mm = 44.0F;  // how far inside the outline a surface may lie: a toe's top does
constexpr int k_layer_bins = 80;

/// The innermost o that still belongs to the outermost layer, per coarse cell.
class Layers {
 public:
  Layers(std::span<const Place> places, const OuterLayerConfig& config, double grow) {
    cols_ = std::max(3, static_cast<int>(config.length_mm / (k_layer_s_mm * grow)));
    row_mm_ = static_cast<float>(k_layer_z_mm * grow);
    rows_ = static_cast<int>(static_cast<float>(config.height_mm) / row_mm_) + 1;
    per_s_ = static_cast<float>(cols_ / config.length_mm);
    z_low_ = static_cast<float>(config.z_low_mm);
    counts_.assign(static_cast<std::size_t>(cols_ * rows_) * k_layer_bins, 0);
    for (const Place& place : places) {
      const std::int32_t cell = cell_of(place);
      if (cell < 0) continue;
      auto& count = counts_[static_cast<std::size_t>(cell) * k_layer_bins + bin_of(place.o_mm)];
      if (count < k_full) ++count;
    }
    limit_.assign(static_cast<std::size_t>(cols_ * rows_), -k_inner_mm);
    const int gap_bins =
        std::max(1, static_cast<int>(std::lround(config.gap_mm / static_cast<double>(k_layer_o_mm))));
    totals_.assign(limit_.size(), 0);
    std::vector<float> top(limit_.size(), k_nothing_mm);
    for (std::size_t cell = 0; cell < limit_.size(); ++cell) {
      const Cluster cluster =
          outermost_cluster({counts_.data() + cell * k_layer_bins, k_layer_bins}, gap_bins);
      limit_[cell] = cluster.low_mm;
      for (std::size_t bin = 0; bin < k_layer_bins; ++bin)
        totals_[cell] += counts_[cell * k_layer_bins + bin];
      top[cell] = cluster.high_mm;
    }
    follow_neighbours(top, static_cast<float>(config.gap_mm));
  }

  [[nodiscard]] bool contains(const Place& place) const {
    const std::int32_t cell = cell_of(place);
    return cell >= 0 && place.o_mm >= limit_[static_cast<std::size_t>(cell)] &&
           !stray(static_cast<std::size_t>(cell), place.o_mm);
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

  [[nodiscard]] std::int32_t cell_of(const Place& place) const {
    if (place.s_mm < 0) return -1;
    const int col = std::min(cols_ - 1, static_cast<int>(place.s_mm * per_s_));
    const int row = static_cast<int>((place.z_mm - z_low_) / row_mm_);
    if (place.z_mm < z_low_ || row >= rows_) return -1;
    return row * cols_ + col;
  }
  static std::size_t bin_of(float o_mm) {
    return static_cast<std::size_t>(
        std::clamp((o_mm + k_inner_mm) / k_layer_o_mm, 0.0F, k_layer_bins - 1.0F));
  }

  struct Cluster {
    float low_mm{-k_inner_mm};
    float high_mm{k_nothing_mm};
  };

  /// Goes inwards from the outermost bin and stops at the first gap behind a cluster that is more than a
  /// stray point.
  static Cluster outermost_cluster(std::span<const std::uint8_t> counts, int gap_bins) {
    std::uint32_t total = 0;
    for (const std::uint8_t count : counts) total += count;
    if (total == 0) return {};
    const std::uint32_t enough = std::clamp<std::uint32_t>(total / 12, 1, 4);
    std::uint32_t cluster = 0;
    int empty = 0;
    int lowest = 0;
    int highest = 0;
    for (int bin = k_layer_bins - 1; bin >= 0; --bin) {
      const std::uint8_t count = counts[static_cast<std::size_t>(bin)];
      if (count > 0) {
        if (cluster == 0) highest = bin;
        cluster += count;
        lowest = bin;
        empty = 0;
      } else if (cluster > 0 && ++empty >= gap_bins) {
        if (cluster >= enough) break;
        cluster = 0;
      }
    }
    const auto edge = [](int bin) { return static_cast<float>(bin) * k_layer_o_mm - k_inner_mm; };
    return {edge(lowest) - 0.01F, edge(highest + 1)};
  }

  /// A cell whose outermost points lie a layer behind those of most cells around it has seen only the inner
  /// layer.
  void follow_neighbours(const std::vector<float>& top, float gap_mm) {
    const std::vector<float> limit = limit_;
    std::array<std::pair<float, float>, 25> around;
    for (int row = 0; row < rows_; ++row) {
      for (int col = 0; col < cols_; ++col) {
        std::size_t count = 0;
        for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
          for (int c = col - 2; c <= col + 2; ++c) {
            const auto other = static_cast<std::size_t>(r * cols_ + (c + cols_) % cols_);
            if (top[other] > k_nothing_mm) around[count++] = {top[other], limit[other]};
          }
        }
        const auto cell = static_cast<std::size_t>(row * cols_ + col);
        if (count < 3 || top[cell] <= k_nothing_mm) continue;
        const auto middle = around.begin() + static_cast<std::ptrdiff_t>(count / 2);
        std::nth_element(around.begin(), middle, around.begin() + static_cast<std::ptrdiff_t>(count));
        if (top[cell] < middle->first - gap_mm - k_layer_o_mm)
          limit_[cell] = std::max(limit_[cell], middle->second);
      }
    }
  }

  static constexpr std::uint8_t k_full = 255;  // nothing here asks for more
  static constexpr float k_nothing_mm = -1000.0F;
  float row_mm_{0};
  int cols_{0};
  int rows_{0};
  float per_s_{0};
  float z_low_{0};
  std::vector<float> limit_;
  std::vector<std::uint8_t> counts_;
  std::vector<std::uint32_t> totals_;
};

/// Outermost o per fine cell, leaving out a twentieth of the points as strays.
class Envelope {
 public:
  Envelope(std::span<const Place> places, const OuterLayerConfig& config, double grow)
      : depth_mm_{static_cast<float>(config.depth_mm)} {
    cols_ = std::max(3, static_cast<int>(config.length_mm / (k_fine_s_mm * grow)));
    per_s_ = static_cast<float>(cols_ / config.length_mm);
    row_mm_ = static_cast<float>(k_fine_z_mm * grow);
    rows_ = static_cast<int>(static_cast<float>(config.height_mm) / row_mm_) + 1;
    z_low_ = static_cast<float>(config.z_low_mm);
    const auto cells = static_cast<std::size_t>(cols_ * rows_);
    // The two largest per cell; with many points in a cell the second one stands for it.
    std::vector<float> first(cells, k_nothing);
    std::vector<float> second(cells, k_nothing);
    std::vector<std::uint16_t> count(cells, 0);
    for (const Place& place : places) {
      const std::int32_t cell = cell_of(place);
      if (cell < 0) continue;
      const auto i = static_cast<std::size_t>(cell);
      if (count[i] < 65535) ++count[i];
      if (place.o_mm > first[i]) {
        second[i] = first[i];
        first[i] = place.o_mm;
      } else {
        second[i] = std::max(second[i], place.o_mm);
      }
    }
    std::vector<float> top(cells);
    for (std::size_t i = 0; i < cells; ++i) top[i] = count[i] >= k_many ? second[i] : first[i];
    floor_.assign(cells, k_nothing);
    for (int row = 0; row < rows_; ++row) {
      for (int col = 0; col < cols_; ++col) {
        float lowest = -k_nothing;
        for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
          const float o = top[static_cast<std::size_t>(r * cols_ + col)];
          if (o > k_nothing) lowest = std::min(lowest, o);
        }
        floor_[static_cast<std::size_t>(row * cols_ + col)] = lowest - depth_mm_;
      }
    }
  }

  [[nodiscard]] bool contains(const Place& place) const {
    const std::int32_t cell = cell_of(place);
    return cell >= 0 && place.o_mm >= floor_[static_cast<std::size_t>(cell)];
  }

 private:
  static constexpr float k_nothing = -1.0e6F;
  static constexpr std::uint16_t k_many = 20;

  [[nodiscard]] std::int32_t cell_of(const Place& place) const {
    if (place.s_mm < 0 || place.z_mm < z_low_) return -1;
    const int row = static_cast<int>((place.z_mm - z_low_) / row_mm_);
    if (row >= rows_) return -1;
    return row * cols_ + std::min(cols_ - 1, static_cast<int>(place.s_mm * per_s_));
  }

  int cols_{0};
  int rows_{0};
  float per_s_{0};
  float row_mm_{0};
  float z_low_{0};
  float depth_mm_;
  std::vector<float> floor_;
};

template <class Layer>
void drop_behind(std::vector<Place>& places, const Layer& layer) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, places.size(), 8192}, [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      if (!layer.contains(places[i])) places[i].s_mm = -1.0F;
    }
  });
}

}  // namespace

void keep_outer_layer(std::vector<Place>& places, const OuterLayerConfig& config) {
  const auto reachable = static_cast<double>(
      std::count_if(places.begin(), places.end(), [](const Place& p) { return p.s_mm >= 0; }));
  const double points_per_mm2 = std::max(reachable / (config.length_mm * config.height_mm), 1e-3);
  const double grow =
      std::clamp(std::sqrt(k_layer_points / (k_layer_s_mm * k_layer_z_mm * points_per_mm2)), 1.0, 3.0);
  drop_behind(places, Layers{places, config, grow});
  drop_behind(places, Envelope{places, config, grow});
}

}  // namespace biteline::groove
