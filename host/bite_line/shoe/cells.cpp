// SPDX-License-Identifier: MIT
#include "host/bite_line/shoe/cells.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace biteline::bite_line {

namespace {

/// Bounds that leave out the far 0.05 % on either side of each axis, then a margin: a single point a metre
/// away must not blow up the grid.
std::pair<Eigen::Vector3f, Eigen::Vector3f> robust_bounds(std::span<const Eigen::Vector3f> points) {
  constexpr std::size_t k_sample = 20'000;
  constexpr float k_margin_mm =
      40.0F;  // one missing sector: what lies farther from everything else is no shoe
  const std::size_t step = std::max<std::size_t>(1, points.size() / k_sample);
  const std::size_t count = (points.size() - 1) / step + 1;
  std::array<std::vector<float>, 3> values;
  for (std::vector<float>& of_axis : values) of_axis.resize(count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, count, 4096}, [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      for (std::size_t axis = 0; axis < values.size(); ++axis)
        values[axis][i] = points[i * step][static_cast<int>(axis)];
    }
  });
  // Few lie beyond: these alone are sorted.
  const auto beyond = [&](std::size_t axis, auto before) {
    std::vector<float> ends(values[axis].size() / 2000 + 1);
    std::partial_sort_copy(values[axis].begin(), values[axis].end(), ends.begin(), ends.end(), before);
    return ends.back();
  };
  Eigen::Vector3f low;
  Eigen::Vector3f high;
  tbb::parallel_for(std::size_t{0}, 2 * values.size(), [&](std::size_t end) {
    const std::size_t axis = end / 2;
    if (end % 2 == 0) {
      low[static_cast<int>(axis)] = beyond(axis, std::less<>{}) - k_margin_mm;
    } else {
      high[static_cast<int>(axis)] = beyond(axis, std::greater<>{}) + k_margin_mm;
    }
  });
  return {low, high};
}

}  // namespace

std::int32_t Cells::cell_at(const Eigen::Vector3f& point) const {
  const Eigen::Vector3f offset = (point - origin_) * inverse_mm_;
  if (offset.minCoeff() < 0.0F) return -1;
  const int x = static_cast<int>(offset.x());
  const int y = static_cast<int>(offset.y());
  const int z = static_cast<int>(offset.z());
  if (x >= size_.x() || y >= size_.y() || z >= size_.z()) return -1;
  return (z * size_.y() + y) * size_.x() + x;
}

Cells::Cells(std::span<const Eigen::Vector3f> points, const Config& config) : cell_mm_{config.cell_mm} {
  if (points.empty()) return;
  const auto [low, high] = robust_bounds(points);
  origin_ = low;
  const Eigen::Vector3f extent = high - low;
  const auto cells_at = [&](float cell_mm) {
    return static_cast<double>((extent / cell_mm).array().ceil().prod());
  };
  while (cells_at(cell_mm_) > static_cast<double>(config.max_cells)) cell_mm_ *= 1.25F;
  inverse_mm_ = 1.0F / cell_mm_;
  size_ = (extent * inverse_mm_).array().ceil().cast<int>().max(1);

  const auto total = static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) *
                     static_cast<std::size_t>(size_.z());
  // Neighbours in the cloud are mostly of one cell: summed up run by run first.
  struct CellRun {
    std::int32_t cell{-1};
    std::uint32_t points{0};
    Eigen::Vector3f sum{Eigen::Vector3f::Zero()};
  };
  constexpr std::size_t k_chunk = 8192;
  std::vector<std::vector<CellRun>> runs((points.size() + k_chunk - 1) / k_chunk);
  cell_of_.resize(points.size());
  const auto collect = [&](std::size_t chunk) {
    CellRun run;
    const auto keep = [&] {
      if (run.cell >= 0) runs[chunk].push_back(run);
    };
    for (std::size_t i = chunk * k_chunk; i < std::min(points.size(), (chunk + 1) * k_chunk); ++i) {
      cell_of_[i] = cell_at(points[i]);
      if (cell_of_[i] != run.cell) {
        keep();
        run = {.cell = cell_of_[i]};
      }
      ++run.points;
      run.sum += points[i] - origin_;
    }
    keep();
  };
  tbb::parallel_invoke([&] { tbb::parallel_for(std::size_t{0}, runs.size(), collect); },
                       [&] { slot_.assign(total, -1); });
  const auto for_runs = [&](auto&& use) {
    for (const std::vector<CellRun>& chunk : runs) {
      for (const CellRun& run : chunk) use(run, static_cast<std::size_t>(run.cell));
    }
  };
  constexpr std::size_t k_word = 64;
  std::vector<std::uint64_t> with_points(total / k_word + 1, 0);
  for_runs([&](const CellRun&, std::size_t cell) {
    with_points[cell / k_word] |= std::uint64_t{1} << cell % k_word;
  });
  for (std::size_t word = 0; word < with_points.size(); ++word) {
    for (std::uint64_t left = with_points[word]; left != 0; left &= left - 1) {
      const std::size_t cell = word * k_word + static_cast<std::size_t>(std::countr_zero(left));
      slot_[cell] = static_cast<std::int32_t>(occupied_.size());
      occupied_.push_back(static_cast<std::int32_t>(cell));
    }
  }
  counts_.assign(occupied_.size(), 0);
  means_.assign(occupied_.size(), Eigen::Vector3f::Zero());
  for_runs([&](const CellRun& run, std::size_t cell) {
    const auto slot = static_cast<std::size_t>(slot_[cell]);
    counts_[slot] += run.points;
    means_[slot] += run.sum;
  });
  for (std::size_t slot = 0; slot < means_.size(); ++slot)
    means_[slot] = origin_ + means_[slot] / static_cast<float>(counts_[slot]);
}

PooledVector<std::uint8_t> Cells::by_cell(std::span<const std::uint8_t> by_slot) const {
  PooledVector<std::uint8_t> values(slot_.size(), 0);
  for (std::size_t slot = 0; slot < occupied_.size(); ++slot)
    values[static_cast<std::size_t>(occupied_[slot])] = by_slot[slot];
  return values;
}

int Cells::label(const std::vector<bool>& keep, std::vector<std::int32_t>& labels) const {
  // Each cell joins the components of its neighbours before it.  A component's root is its first cell.
  std::vector<std::size_t> parent(occupied_.size());
  const auto root_of = [&](std::size_t slot) {
    while (parent[slot] != slot) slot = parent[slot] = parent[parent[slot]];
    return slot;
  };
  for (std::size_t slot = 0; slot < parent.size(); ++slot) {
    parent[slot] = slot;
    if (!keep[slot]) continue;
    std::size_t root = slot;
    around<true>(slot, [&](std::size_t other) {
      if (!keep[other]) return;
      const std::size_t of_other = root_of(other);
      parent[std::max(root, of_other)] = std::min(root, of_other);
      root = std::min(root, of_other);
    });
  }
  labels.assign(occupied_.size(), -1);
  int components = 0;
  for (std::size_t slot = 0; slot < parent.size(); ++slot) {
    if (!keep[slot]) continue;
    const std::size_t root = root_of(slot);
    labels[slot] = root == slot ? components++ : labels[root];
  }
  return components;
}

}  // namespace biteline::bite_line
