// SPDX-License-Identifier: MIT
#include "host/bite_line/shoe/outline_lookup.hpp"

#include <algorithm>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "common/core/contracts.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/bite_line/shoe/outline_lookup.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace biteline::bite_line {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Lanes(d) points from `from` to `to`, each three floats.
template <class D>
HWY_INLINE void locate_lanes(D d, const OutlineLookup::Table& table, const float* from, float* to) {
  using V = hn::Vec<D>;
  const hn::Rebind<std::int32_t, D> di;
  const auto set = [&](float value) { return hn::Set(d, value); };
  V x, y, z;
  hn::LoadInterleaved3(d, from, x, y, z);
  const V per_cell = set(1.0F / OutlineLookup::Table::k_cell_mm);
  const V column = hn::Mul(hn::Sub(x, set(table.origin.x())), per_cell);
  const V line = hn::Mul(hn::Sub(y, set(table.origin.y())), per_cell);
  const V zero = hn::Zero(d);
  const auto within = [&](V at, int count) {
    return hn::And(hn::Ge(at, zero), hn::Lt(at, set(static_cast<float>(count))));
  };
  const auto inside = hn::RebindMask(di, hn::And(within(column, table.cols), within(line, table.rows)));
  const auto cell =
      hn::Add(hn::Mul(hn::ConvertTo(di, line), hn::Set(di, table.cols)), hn::ConvertTo(di, column));
  auto sample = hn::GatherIndex(di, table.nearest.data(), hn::IfThenElseZero(inside, cell));
  const auto reached = hn::And(inside, hn::Gt(sample, hn::Set(di, -1)));
  sample = hn::IfThenElseZero(reached, sample);

  const auto* samples = reinterpret_cast<const float*>(table.samples.data());
  constexpr int k_floats = sizeof(OutlineLookup::Sample) / sizeof(float);
  const auto count = static_cast<int>(table.samples.size());
  const float spacing_mm = table.length_mm / static_cast<float>(count);
  V along = zero;
  V outwards = zero;
  // An offset curve at o is (1 + bend o) times as long.
  for (int step = 0;; ++step) {
    const auto at = hn::Mul(sample, hn::Set(di, k_floats));
    const V rx = hn::Sub(x, hn::GatherIndex(d, samples, at));
    const V ry = hn::Sub(y, hn::GatherIndex(d, samples + 1, at));
    const V nx = hn::GatherIndex(d, samples + 2, at);
    const V ny = hn::GatherIndex(d, samples + 3, at);
    const V bend = hn::GatherIndex(d, samples + 4, at);
    outwards = hn::MulAdd(rx, nx, hn::Mul(ry, ny));
    const V stretch = hn::Max(set(0.2F), hn::MulAdd(bend, outwards, set(1.0F)));
    along = hn::Div(hn::NegMulAdd(rx, ny, hn::Mul(ry, nx)), stretch);
    if (step == 2) break;
    const auto jump = hn::NearestInt(hn::Mul(along, set(1.0F / spacing_mm)));
    const auto whole = hn::Max(hn::Set(di, 1 - count), hn::Min(hn::Set(di, count - 1), jump));
    if (hn::AllTrue(di, hn::Eq(whole, hn::Zero(di)))) break;
    sample = hn::Add(sample, whole);
    sample = hn::Add(sample, hn::IfThenElseZero(hn::Lt(sample, hn::Zero(di)), hn::Set(di, count)));
    sample = hn::Sub(sample, hn::IfThenElseZero(hn::Gt(sample, hn::Set(di, count - 1)), hn::Set(di, count)));
  }
  V s = hn::MulAdd(hn::ConvertTo(d, sample), set(spacing_mm), along);
  s = hn::Add(s, hn::IfThenElseZero(hn::Lt(s, zero), set(table.length_mm)));
  s = hn::Sub(s, hn::IfThenElseZero(hn::Ge(s, set(table.length_mm)), set(table.length_mm)));
  s = hn::IfThenElse(hn::RebindMask(d, reached), s, set(-1.0F));
  hn::StoreInterleaved3(s, outwards, z, d, to);
}

/// Part of a row of the table: squared distances to the sample, the row's first cell lying (dx, dy) from it.
template <class D>
HWY_INLINE void stamp_lanes(D d, std::int32_t sample, float dx, float dy, float* best,
                            std::int32_t* nearest) {
  const hn::Rebind<std::int32_t, D> di;
  const auto x = hn::MulAdd(hn::Iota(d, 0), hn::Set(d, OutlineLookup::Table::k_cell_mm), hn::Set(d, dx));
  const auto distance2 = hn::MulAdd(x, x, hn::Set(d, dy * dy));
  const auto before = hn::LoadU(d, best);
  const auto nearer = hn::Lt(distance2, before);
  hn::StoreU(hn::IfThenElse(nearer, distance2, before), d, best);
  hn::StoreU(hn::IfThenElse(hn::RebindMask(di, nearer), hn::Set(di, sample), hn::LoadU(di, nearest)), di,
             nearest);
}

/// The rows from `first_row` on, of the cells within reach of the samples, `stride` samples apart.
void stamp_rows(OutlineLookup::Table& table, float reach_mm, std::size_t stride, int first_row, int end_row,
                std::vector<float>& distance2) {
  constexpr float k_cell_mm = OutlineLookup::Table::k_cell_mm;
  const hn::CappedTag<float, 16> d;
  const hn::CappedTag<float, 1> one;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const int reach = static_cast<int>(reach_mm / k_cell_mm) + 1;
  for (std::size_t i = 0; i < table.samples.size(); i += stride) {
    const float x = (table.samples[i].x_mm - table.origin.x()) / k_cell_mm;
    const float y = (table.samples[i].y_mm - table.origin.y()) / k_cell_mm;
    const int first = std::max(0, static_cast<int>(x) - reach);
    const int end = std::min(table.cols, static_cast<int>(x) + reach + 1);
    const int last_row = std::min(end_row - 1, static_cast<int>(y) + reach);
    for (int r = std::max(first_row, static_cast<int>(y) - reach); r <= last_row; ++r) {
      const float dy = (static_cast<float>(r) + 0.5F - y) * k_cell_mm;
      float* best = distance2.data() + r * table.cols;
      std::int32_t* nearest = table.nearest.data() + r * table.cols;
      const auto stamp = [&](auto tag, int c) {
        const float dx = (static_cast<float>(c) + 0.5F - x) * k_cell_mm;
        stamp_lanes(tag, static_cast<std::int32_t>(i), dx, dy, best + c, nearest + c);
      };
      int c = first;
      for (; c + lanes <= end; c += lanes) stamp(d, c);
      // The last vector reaches back over what is done already, which changes nothing there.
      if (c < end && end - first >= lanes) {
        stamp(d, end - lanes);
      } else {
        for (; c < end; ++c) stamp(one, c);
      }
    }
  }
}

void locate_all(const OutlineLookup::Table& table, std::span<const Eigen::Vector3f> points, float* to) {
  const hn::CappedTag<float, 16> d;
  const hn::CappedTag<float, 1> one;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= points.size(); i += lanes) locate_lanes(d, table, points[i].data(), to + 3 * i);
  for (; i < points.size(); ++i) locate_lanes(one, table, points[i].data(), to + 3 * i);
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::bite_line
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::bite_line {

HWY_EXPORT(locate_all);
HWY_EXPORT(stamp_rows);

OutlineLookup::OutlineLookup(std::vector<Sample> samples, float length_mm, float reach_mm) {
  Eigen::AlignedBox2f box;
  for (const Sample& sample : samples) box.extend(Eigen::Vector2f{sample.x_mm, sample.y_mm});
  const Eigen::Vector2f size = box.sizes() + Eigen::Vector2f::Constant(2 * reach_mm);
  table_.length_mm = length_mm;
  table_.origin = box.min() - Eigen::Vector2f::Constant(reach_mm);
  table_.cols = static_cast<int>(size.x() / Table::k_cell_mm) + 1;
  table_.rows = static_cast<int>(size.y() / Table::k_cell_mm) + 1;
  const auto cells = static_cast<std::size_t>(table_.cols) * static_cast<std::size_t>(table_.rows);
  table_.nearest.assign(cells, -1);
  std::vector<float> distance2(cells, reach_mm * reach_mm);
  // A sample every 2 mm is enough to start from.
  const float per_sample_mm = length_mm / static_cast<float>(samples.size());
  table_.samples = std::move(samples);
  const auto stride = static_cast<std::size_t>(std::max(1.0F, 2.0F / per_sample_mm));
  tbb::parallel_for(tbb::blocked_range<int>{0, table_.rows, 8}, [&](const auto& range) {
    HWY_DYNAMIC_DISPATCH(stamp_rows)(table_, reach_mm, stride, range.begin(), range.end(), distance2);
  });
}

void OutlineLookup::locate(std::span<const Eigen::Vector3f> points, std::span<OutlinePlace> places) const {
  BITELINE_EXPECTS(places.size() == points.size());
  static_assert(sizeof(OutlinePlace) == 3 * sizeof(float));
  HWY_DYNAMIC_DISPATCH(locate_all)(table_, points, reinterpret_cast<float*>(places.data()));
}

}  // namespace biteline::bite_line
#endif  // HWY_ONCE
