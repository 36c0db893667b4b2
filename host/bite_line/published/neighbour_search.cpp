// SPDX-License-Identifier: MIT
#include "host/bite_line/published/neighbour_search.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/bite_line/published/neighbour_search.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace biteline::published {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using Indices = hn::RebindToUnsigned<D>;

std::size_t collect_near_lanes(const NeighbourSearch::Block& block, const Eigen::Vector3f& place,
                               float most2_mm2, NeighbourSearch::Near& near) {
  const D d;
  const Indices di;
  const auto px = hn::Set(d, place.x());
  const auto py = hn::Set(d, place.y());
  const auto pz = hn::Set(d, place.z());
  const auto most = hn::Set(d, most2_mm2);
  std::size_t count = 0;
  for (std::size_t i = 0; i < block.size; i += hn::Lanes(d)) {
    const auto x = hn::Sub(hn::LoadU(d, block.x.data() + i), px);
    const auto y = hn::Sub(hn::LoadU(d, block.y.data() + i), py);
    const auto z = hn::Sub(hn::LoadU(d, block.z.data() + i), pz);
    const auto distance2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto is_near = hn::Le(distance2, most);
    hn::CompressStore(hn::LoadU(di, block.index.data() + i), hn::RebindMask(di, is_near), di,
                      near.index.data() + count);
    count += hn::CompressStore(distance2, is_near, d, near.distance2_mm2.data() + count);
  }
  return count;
}

/// Of the first `size` near ones the `count` nearest; the squared distance of the farthest of these.
float choose_nearest_lanes(NeighbourSearch::Near& near, std::size_t size, std::size_t count,
                           float most2_mm2) {
  const D d;
  const Indices di;
  const std::size_t lanes = hn::Lanes(d);
  hn::StoreU(hn::Set(d, 1e30F), d, near.distance2_mm2.data() + size);
  const auto up_to = [&](float limit) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < size; i += lanes)
      n += hn::CountTrue(d, hn::Le(hn::LoadU(d, near.distance2_mm2.data() + i), hn::Set(d, limit)));
    return n;
  };
  // On a surface the number within a distance grows with its square: interpolation finds the limit in a few
  // steps, halving guarantees it.  What is left between two neighbouring numbers is equally far.
  float low = -1.0F;
  float high = most2_mm2;
  std::size_t n_low = 0;
  std::size_t n_high = size;
  for (int step = 0; n_high != count; ++step) {
    const float share = step % 3 == 2 ? 0.5F
                                      : (static_cast<float>(count - n_low) + 0.5F) /
                                            (static_cast<float>(n_high - n_low) + 1.0F);
    const float base = std::max(low, 0.0F);
    float middle = base + share * (high - base);
    if (!(middle > low && middle < high)) middle = std::nextafter(high, low);
    if (middle <= low) break;
    const std::size_t n = up_to(middle);
    (n < count ? low : high) = middle;
    (n < count ? n_low : n_high) = n;
  }
  std::size_t chosen = 0;
  auto farthest = hn::Zero(d);
  const auto choose = [&](float above, float limit) {
    for (std::size_t i = 0; i < size && chosen < count; i += lanes) {
      const auto distance2 = hn::LoadU(d, near.distance2_mm2.data() + i);
      const auto taken = hn::And(hn::Gt(distance2, hn::Set(d, above)), hn::Le(distance2, hn::Set(d, limit)));
      farthest = hn::Max(farthest, hn::IfThenElseZero(taken, distance2));
      chosen += hn::CompressStore(hn::LoadU(di, near.index.data() + i), hn::RebindMask(di, taken), di,
                                  near.chosen.data() + chosen);
    }
  };
  if (n_high != count) choose(-1.0F, low);
  choose(n_high != count ? low : -1.0F, high);
  return hn::GetLane(hn::MaxOfLanes(d, farthest));
}

std::size_t vector_size_lanes() {
  return hn::Lanes(D());
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::published
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::published {

HWY_EXPORT(collect_near_lanes);
HWY_EXPORT(choose_nearest_lanes);
HWY_EXPORT(vector_size_lanes);

const NeighbourSearch::Block& NeighbourSearch::around(std::uint32_t index, int ring) {
  Block& block = blocks_[ring > 1 ? 1 : 0];
  const Eigen::Vector3i cell = grid_->cell_at({grid_->x()[index], grid_->y()[index], grid_->z()[index]});
  if (block.ring == ring && block.cell == cell) return block;
  block.cell = cell;
  block.ring = ring;
  block.x.clear();
  block.y.clear();
  block.z.clear();
  block.index.clear();
  grid_->for_each_run(cell, ring, [&](std::uint32_t begin, std::uint32_t end) {
    block.x.insert(block.x.end(), grid_->x() + begin, grid_->x() + end);
    block.y.insert(block.y.end(), grid_->y() + begin, grid_->y() + end);
    block.z.insert(block.z.end(), grid_->z() + begin, grid_->z() + end);
    for (std::uint32_t i = begin; i < end; ++i) block.index.push_back(i);
  });
  block.size = block.x.size();
  const std::size_t room = block.size + HWY_DYNAMIC_DISPATCH(vector_size_lanes)();
  constexpr float k_far_mm = 1e15F;
  for (std::vector<float>* values : {&block.x, &block.y, &block.z}) values->resize(room, k_far_mm);
  block.index.resize(room, 0);
  near_.distance2_mm2.resize(std::max(room, near_.distance2_mm2.size()));
  near_.index.resize(near_.distance2_mm2.size());
  near_.chosen.resize(near_.distance2_mm2.size());
  return block;
}

std::span<const std::uint32_t> NeighbourSearch::within(std::uint32_t index, float radius_mm) {
  const int ring = std::max(1, static_cast<int>(std::ceil(radius_mm / grid_->cell_mm())));
  const Block& block = around(index, ring);
  const std::size_t count = HWY_DYNAMIC_DISPATCH(collect_near_lanes)(
      block, {grid_->x()[index], grid_->y()[index], grid_->z()[index]}, radius_mm * radius_mm, near_);
  return {near_.index.data(), count};
}

NeighbourSearch::Nearest NeighbourSearch::nearest(std::uint32_t index, std::size_t count) {
  count = std::min(count, grid_->size());
  // What lies within a ring's width is complete.
  for (int ring = 1;; ring *= 2) {
    const float reach_mm = static_cast<float>(ring) * grid_->cell_mm();
    const std::size_t found = within(index, reach_mm).size();
    if (found < count) continue;
    const float farthest2_mm2 =
        HWY_DYNAMIC_DISPATCH(choose_nearest_lanes)(near_, found, count, reach_mm * reach_mm);
    return {{near_.chosen.data(), count}, std::sqrt(farthest2_mm2)};
  }
}

}  // namespace biteline::published
#endif  // HWY_ONCE
