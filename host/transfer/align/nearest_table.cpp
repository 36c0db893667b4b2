// SPDX-License-Identifier: MIT
#include "host/transfer/align/nearest_table.hpp"

#include <cmath>

#include "common/core/numbers.hpp"

namespace biteline::transfer {
namespace {

// 32 MB.  A shoe at 2 mm pitch needs a hundredth; a scan with stray points far away gets larger cells
// instead.
constexpr double k_max_cells = 8e6;

}  // namespace

NearestTable::NearestTable(const Surfels& surfels, float reach_mm) {
  if (surfels.size() == 0) return;
  Eigen::Vector3f low = surfels.positions.front(), high = low;
  for (const Eigen::Vector3f& p : surfels.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3f margin = Eigen::Vector3f::Constant(reach_mm + surfels.pitch_mm);
  origin_ = low - margin;
  const Eigen::Array3d span = (high - low + 2 * margin).cast<double>();
  // Readers let nothing farther through; without this no table is better than one that overflows.
  if (!(span < 4 * k_far_mm).all() || !(surfels.pitch_mm > 0)) return;
  double cell_mm = surfels.pitch_mm;
  // Rounded up axis by axis, a flat box may need more than its volume says: grow until it fits.
  const auto cells_of = [&] { return (span / cell_mm).ceil().cwiseMax(1).prod(); };
  while (cells_of() > k_max_cells) cell_mm *= std::max(1.05, std::cbrt(cells_of() / k_max_cells));
  per_mm_ = static_cast<float>(1 / cell_mm);
  size_ = (span / cell_mm).ceil().cwiseMax(1).cast<int>();
  extent_ = size_.cast<float>();
  cells_.assign(static_cast<std::size_t>(size_.cast<std::int64_t>().prod()), k_none);
  fill(surfels, reach_mm);
}

/// Breadth first from the surface: each cell hands its surfel to its six neighbours, which keep the nearer
/// one.
void NearestTable::fill(const Surfels& surfels, float reach_mm) {
  const float cell_mm = 1 / per_mm_;
  const float reach_squared = (reach_mm + cell_mm) * (reach_mm + cell_mm);
  // Squared distance of each cell's centre from its surfel: what another offer must be below.
  std::vector<float> best(cells_.size(), reach_squared);
  std::vector<std::uint32_t> wave, next;
  const auto offer = [&](std::uint32_t cell, const Eigen::Vector3f& centre, std::uint32_t surfel,
                         std::vector<std::uint32_t>& out) {
    const float distance = (surfels.positions[surfel] - centre).squaredNorm();
    if (distance >= best[cell]) return;
    best[cell] = distance;
    cells_[cell] = surfel;
    out.push_back(cell);
  };
  const auto centre_of = [&](int x, int y, int z) -> Eigen::Vector3f {
    return origin_ + cell_mm * Eigen::Vector3f(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F,
                                               static_cast<float>(z) + 0.5F);
  };
  for (std::uint32_t i = 0; i < surfels.size(); ++i) {
    // Rounding may put a point on the far rim one cell beyond it.
    const Eigen::Array3i at =
        ((surfels.positions[i] - origin_).array() * per_mm_).cast<int>().cwiseMin(size_ - 1).cwiseMax(0);
    offer(static_cast<std::uint32_t>(at.x() + size_.x() * (at.y() + size_.y() * at.z())),
          centre_of(at.x(), at.y(), at.z()), i, wave);
  }
  const int row = size_.x(), layer = size_.x() * size_.y();
  while (!wave.empty()) {
    next.clear();
    for (const std::uint32_t cell : wave) {
      const int at = static_cast<int>(cell);
      const int x = at % row, y = at / row % size_.y(), z = at / layer;
      const std::uint32_t surfel = cells_[cell];
      const Eigen::Vector3f centre = centre_of(x, y, z);
      const auto hand = [&](bool inside, int axis, float step_mm, int stride) {
        if (!inside) return;
        Eigen::Vector3f beside = centre;
        beside[axis] += step_mm;
        offer(static_cast<std::uint32_t>(at + stride), beside, surfel, next);
      };
      hand(x > 0, 0, -cell_mm, -1);
      hand(x + 1 < size_.x(), 0, cell_mm, 1);
      hand(y > 0, 1, -cell_mm, -row);
      hand(y + 1 < size_.y(), 1, cell_mm, row);
      hand(z > 0, 2, -cell_mm, -layer);
      hand(z + 1 < size_.z(), 2, cell_mm, layer);
    }
    wave.swap(next);
  }
}

}  // namespace biteline::transfer
