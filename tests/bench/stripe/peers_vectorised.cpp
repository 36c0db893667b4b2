// SPDX-License-Identifier: MIT
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/stripe/peers_vectorised.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <vector>

#include "tests/bench/stripe/peers.hpp"

HWY_BEFORE_NAMESPACE();
namespace biteline::bench {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::uint64_t sum(const std::uint8_t* bytes, std::size_t count) {
  const hn::ScalableTag<std::uint8_t> d8;
  const hn::Repartition<std::uint64_t, decltype(d8)> d64;
  const std::size_t step = hn::Lanes(d8);
  auto a = hn::Zero(d64), b = a, c = a, e = a;
  std::size_t i = 0;
  for (; i + 4 * step <= count; i += 4 * step) {
    for (std::size_t line = 0; line < 4 * step; line += 64)
      hwy::Prefetch(bytes + std::min(i + line + 4096, count - 1));
    a = hn::Add(a, hn::SumsOf8(hn::LoadU(d8, bytes + i)));
    b = hn::Add(b, hn::SumsOf8(hn::LoadU(d8, bytes + i + step)));
    c = hn::Add(c, hn::SumsOf8(hn::LoadU(d8, bytes + i + 2 * step)));
    e = hn::Add(e, hn::SumsOf8(hn::LoadU(d8, bytes + i + 3 * step)));
  }
  std::uint64_t total = hn::GetLane(hn::SumOfLanes(d64, hn::Add(hn::Add(a, b), hn::Add(c, e))));
  for (; i < count; ++i) total += bytes[i];
  return total;
}

constexpr std::size_t k_rows = 8;

/// Running maximum of each column and the block of eight rows that holds it.
void argmax(const std::uint8_t* pixels, std::size_t width, std::size_t height, std::uint8_t* maximum,
            std::uint8_t* block) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t step = hn::Lanes(d);
  std::fill_n(maximum, width, std::uint8_t{0});
  std::fill_n(block, width, std::uint8_t{0});
  for (std::size_t row = 0; row + k_rows <= height; row += k_rows) {
    const std::uint8_t* p = pixels + row * width;
    const auto index = hn::Set(d, static_cast<std::uint8_t>(row / k_rows));
    for (std::size_t start = 0; start < width; start += step) {
      const std::size_t u = std::min(start, width - step);
      auto highest = hn::LoadU(d, p + u);
      for (std::size_t k = 1; k < k_rows; ++k) highest = hn::Max(highest, hn::LoadU(d, p + k * width + u));
      for (std::size_t k = 0; k < k_rows; ++k) hwy::Prefetch(p + (k + 2 * k_rows) * width + u);
      const auto best = hn::LoadU(d, maximum + u);
      hn::StoreU(hn::IfThenElse(hn::Gt(highest, best), index, hn::LoadU(d, block + u)), d, block + u);
      hn::StoreU(hn::Max(highest, best), d, maximum + u);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::bench {
namespace {
HWY_EXPORT(sum);
HWY_EXPORT(argmax);
}  // namespace

std::uint64_t sum_of_bytes(std::span<const std::uint8_t> bytes) {
  return HWY_DYNAMIC_DISPATCH(sum)(bytes.data(), bytes.size());
}

void argmax_and_gravity(const PeerFrame& frame, std::span<float> row_px) {
  const auto width = static_cast<std::size_t>(frame.width_px),
             height = static_cast<std::size_t>(frame.height_px);
  static std::vector<std::uint8_t> maximum, block;
  maximum.resize(width);
  block.resize(width);
  HWY_DYNAMIC_DISPATCH(argmax)(frame.pixels, width, height, maximum.data(), block.data());
  for (std::size_t u = 0; u < width; ++u) {
    row_px[u] = -1;
    if (maximum[u] < 12) continue;
    std::size_t top = block[u] * std::size_t{8};
    while (frame.pixels[top * width + u] != maximum[u]) ++top;
    float sum = 0, moment = 0;
    const std::size_t first = top < 8 ? 0 : top - 8, last = std::min(height - 1, top + 8);
    for (std::size_t row = first; row <= last; ++row) {
      const auto grey = static_cast<float>(frame.pixels[row * width + u]);
      sum += grey;
      moment += grey * static_cast<float>(row);
    }
    row_px[u] = moment / sum;
  }
}

}  // namespace biteline::bench
#endif  // HWY_ONCE
