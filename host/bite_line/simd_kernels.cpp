// SPDX-License-Identifier: MIT
#include "host/bite_line/simd_kernels.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/bite_line/simd_kernels.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace biteline::bite_line {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// K vectors from `i` on, the last one from `last` on: sums stay in registers over all terms.  `term(j)` is
/// the j-th row and its weight.
template <std::size_t K, class D, class Term>
HWY_INLINE void sum_rows(D d, float* to, std::size_t terms, std::size_t i, std::size_t last, Term&& term) {
  const auto at = [&](std::size_t k) { return k + 1 < K ? i + k * hn::Lanes(d) : last; };
  hn::Vec<D> sum[K];
  for (auto& s : sum) s = hn::Zero(d);
  for (std::size_t j = 0; j < terms; ++j) {
    const WeightedRow tap = term(j);
    const auto weight = hn::Set(d, tap.weight);
    for (std::size_t k = 0; k < K; ++k) sum[k] = hn::MulAdd(weight, hn::LoadU(d, tap.from + at(k)), sum[k]);
  }
  for (std::size_t k = 0; k < K; ++k) hn::StoreU(sum[k], d, to + at(k));
}

/// Four vectors at once, and what is left at once, too: one vector alone waits for its own sum at each term.
/// The last one reaches back over what is done already.
template <class Term>
HWY_INLINE void sum_terms(std::span<float> to, std::size_t terms, Term&& term) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> one;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t size = to.size();
  std::size_t i = 0;
  if (size < lanes) {
    for (; i < size; ++i) sum_rows<1>(one, to.data(), terms, i, i, term);
    return;
  }
  for (; i + 4 * lanes <= size; i += 4 * lanes) sum_rows<4>(d, to.data(), terms, i, i + 3 * lanes, term);
  const std::size_t last = size - lanes;
  switch ((size - i + lanes - 1) / lanes) {
    case 1:
      return sum_rows<1>(d, to.data(), terms, i, last, term);
    case 2:
      return sum_rows<2>(d, to.data(), terms, i, last, term);
    case 3:
      return sum_rows<3>(d, to.data(), terms, i, last, term);
    case 4:
      return sum_rows<4>(d, to.data(), terms, i, last, term);
    default:
      return;
  }
}

void sum_rows_simd(std::span<float> to, std::span<const WeightedRow> taps) {
  sum_terms(to, taps.size(), [&](std::size_t j) { return taps[j]; });
}

void convolve_lanes(std::span<float> to, const float* from, std::span<const float> kernel) {
  sum_terms(to, kernel.size(), [&](std::size_t j) { return WeightedRow{from + j, kernel[j]}; });
}

/// Calls `work(d, i)` for whole vectors.  The last one reaches back over what is done already: the same once
/// more costs less than value by value.
template <class Work>
HWY_INLINE void for_lanes(std::size_t size, Work&& work) {
  const hn::ScalableTag<float> d;
  const hn::CappedTag<float, 1> one;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= size; i += hn::Lanes(d)) work(d, i);
  if (i == size) return;
  if (size >= hn::Lanes(d)) {
    work(d, size - hn::Lanes(d));
  } else {
    for (; i < size; ++i) work(one, i);
  }
}

template <class D, class M>
HWY_INLINE void store_flags(D, M flags, std::uint8_t* to) {
  const hn::Rebind<std::int32_t, D> whole;
  const hn::Rebind<std::uint8_t, D> narrow;
  hn::StoreU(hn::DemoteTo(narrow, hn::IfThenElseZero(hn::RebindMask(whole, flags), hn::Set(whole, 1))),
             narrow, to);
}

template <class D, class V>
HWY_INLINE V line_at_zero(D d, V w, V x, V xx, V value, V x_value, float least_spread) {
  const V det = hn::Sub(hn::Mul(w, xx), hn::Mul(x, x));
  const auto spread = hn::Gt(det, hn::Mul(hn::Set(d, least_spread), hn::Mul(w, w)));
  const V above = hn::IfThenElse(spread, hn::Sub(hn::Mul(value, xx), hn::Mul(x_value, x)), value);
  return hn::Div(above, hn::Max(hn::IfThenElse(spread, det, w), hn::Set(d, 1e-6F)));
}

void fit_lines_lanes(const LineSums& sums, const LineFit& fit, std::span<float> to, std::uint8_t* known) {
  for_lanes(to.size(), [&](auto d, std::size_t i) {
    const auto w = hn::LoadU(d, sums.w + i);
    const auto line =
        line_at_zero(d, w, hn::LoadU(d, sums.x + i), hn::LoadU(d, sums.xx + i), hn::LoadU(d, sums.value + i),
                     hn::LoadU(d, sums.x_value + i), fit.least_spread);
    const auto enough = hn::Ge(w, hn::Set(d, fit.least_weight));
    hn::StoreU(hn::IfThenElseZero(enough, line), d, to.data() + i);
    store_flags(d, enough, known + i);
  });
}

void fit_rows_lanes(std::span<const RowOfSums> rows, const LineFit& fit, std::span<float> to,
                    std::uint8_t* known) {
  constexpr float k_least_share = 0.12F;  // of the weight, on either side
  for_lanes(to.size(), [&](auto d, std::size_t i) {
    const auto zero = hn::Zero(d);
    auto w = zero, x = zero, xx = zero, value = zero, x_value = zero, low = zero, high = zero;
    for (const RowOfSums& row : rows) {
      // Weighted sums of the row's points, x counted from row 0: x + at, and its square.
      const auto weight = hn::Set(d, row.weight);
      const auto at = hn::Set(d, row.at);
      const auto n = hn::Mul(weight, hn::LoadU(d, row.w + i));
      const auto nx = hn::Mul(weight, hn::LoadU(d, row.x + i));
      const auto nv = hn::Mul(weight, hn::LoadU(d, row.value + i));
      w = hn::Add(w, n);
      x = hn::Add(x, hn::MulAdd(at, n, nx));
      xx = hn::MulAdd(at, hn::MulAdd(at, n, hn::Add(nx, nx)), xx);
      value = hn::Add(value, nv);
      x_value = hn::Add(x_value, hn::MulAdd(weight, hn::LoadU(d, row.x_value + i), hn::Mul(at, nv)));
      if (row.at < 0) low = hn::Add(low, n);
      if (row.at > 0) high = hn::Add(high, n);
    }
    const auto enough = hn::Ge(w, hn::Set(d, fit.least_weight));
    const auto both = hn::Gt(hn::Min(low, high), hn::Mul(hn::Set(d, k_least_share), w));
    hn::StoreU(hn::IfThenElseZero(enough, line_at_zero(d, w, x, xx, value, x_value, fit.least_spread)), d,
               to.data() + i);
    store_flags(d, hn::And(enough, both), known + i);
  });
}

/// Abramowitz and Stegun 4.4.49.
void slope_angles_lanes(std::span<float> to, const float* low, const float* high, float per_span) {
  for_lanes(to.size(), [&](auto d, std::size_t i) {
    const auto set = [&](float value) { return hn::Set(d, value); };
    const auto slope = hn::Mul(hn::Sub(hn::LoadU(d, high + i), hn::LoadU(d, low + i)), set(per_span));
    const auto size = hn::Abs(slope);
    const auto steep = hn::Gt(size, set(1.0F));
    const auto t = hn::IfThenElse(steep, hn::Div(set(1.0F), hn::Max(size, set(1.0F))), size);
    const auto t2 = hn::Mul(t, t);
    auto series = hn::MulAdd(t2, set(0.0208351F), set(-0.0851330F));
    series = hn::MulAdd(t2, series, set(0.1801410F));
    series = hn::MulAdd(t2, series, set(-0.3302995F));
    const auto small = hn::Mul(t, hn::MulAdd(t2, series, set(0.9998660F)));
    const auto angle = hn::IfThenElse(steep, hn::Sub(set(1.57079633F), small), small);
    hn::StoreU(hn::CopySign(angle, slope), d, to.data() + i);
  });
}

void curvatures_lanes(std::span<float> to, const float* from, float per_mm) {
  for_lanes(to.size(), [&](auto d, std::size_t i) {
    const auto low = hn::LoadU(d, from + i), middle = hn::LoadU(d, from + i + 1),
               high = hn::LoadU(d, from + i + 2);
    const auto slope = hn::Mul(hn::Set(d, 0.5F * per_mm), hn::Sub(high, low));
    const auto bow = hn::Add(hn::Sub(high, hn::Add(middle, middle)), low);
    const auto stretch = hn::MulAdd(slope, slope, hn::Set(d, 1.0F));
    hn::StoreU(hn::Div(hn::Mul(hn::Set(d, per_mm * per_mm), bow), hn::Mul(stretch, hn::Sqrt(stretch))), d,
               to.data() + i);
  });
}

/// Lanes(d) places from `from` to `to`, of three and four numbers each.
template <class D>
HWY_INLINE void land_lanes(D d, const PathGrid& grid, const float* from, float* to) {
  using V = hn::Vec<D>;
  const hn::Rebind<std::int32_t, D> di;
  const auto set = [&](float value) { return hn::Set(d, value); };
  const auto stations = hn::Set(di, static_cast<std::int32_t>(grid.steps.size()));
  V s, o, z;
  hn::LoadInterleaved3(d, from, s, o, z);
  const V at = hn::Mul(s, set(1.0F / grid.station_mm));
  const auto before = hn::ConvertTo(di, at);
  const auto nearest = hn::ConvertTo(di, hn::Add(at, set(0.5F)));
  const auto within = hn::And(hn::Gt(before, hn::Set(di, -1)), hn::Lt(before, stations));
  const auto step = hn::Add(hn::IfThenElseZero(within, before), hn::IfThenElseZero(within, before));
  const V path_z = hn::GatherIndex(d, &grid.steps.front().z_mm, step);
  const V rise = hn::GatherIndex(d, &grid.steps.front().rise_mm, step);
  const V up = hn::Sub(z, hn::MulAdd(hn::Sub(at, hn::ConvertTo(d, before)), rise, path_z));
  const V row = hn::Add(hn::MulAdd(up, set(grid.per_row), set(grid.zero_row)), set(0.5F));
  const V zero = hn::Zero(d);
  const auto beside = hn::And(hn::Ge(s, zero), hn::Le(hn::Abs(o), set(grid.reach_o_mm)));
  const auto inside = hn::And(beside, hn::And(hn::Ge(row, zero), hn::Lt(row, set(grid.rows))));
  const auto station = hn::IfThenElseZero(hn::Lt(nearest, stations), nearest);
  const auto landed = hn::IfThenElse(hn::RebindMask(di, inside), station, hn::Set(di, -1));
  const auto landed_row = hn::ConvertTo(di, hn::IfThenElseZero(inside, row));
  const V off = hn::Mul(hn::Sub(at, hn::ConvertTo(d, nearest)), set(grid.station_mm));
  hn::StoreInterleaved4(hn::BitCast(d, landed), hn::BitCast(d, landed_row), off, o, d, to);
}

void land_all(std::span<Landing> to, std::span<const OutlinePlace> places, const PathGrid& grid) {
  static_assert(sizeof(Landing) == 4 * sizeof(float) && sizeof(OutlinePlace) == 3 * sizeof(float) &&
                sizeof(PathGrid::Step) == 2 * sizeof(float));
  const auto* from = reinterpret_cast<const float*>(places.data());
  auto* landings = reinterpret_cast<float*>(to.data());
  for_lanes(to.size(), [&](auto d, std::size_t i) { land_lanes(d, grid, from + 3 * i, landings + 4 * i); });
}

/// Rows `r` to `r + lanes` at once.  `Steps`: of the penalty; 0: as many as it has.
template <std::size_t Steps, class D>
HWY_INLINE void step_rows(D d, const ColumnStep& column, std::size_t r, float* total, std::int8_t* step) {
  const hn::Rebind<std::int32_t, D> whole;
  const hn::Rebind<std::uint32_t, D> bits;
  const hn::Rebind<std::uint8_t, D> narrow;
  const std::size_t steps = Steps > 0 ? Steps : column.penalty.size();
  const std::size_t reach = steps / 2;
  const float* before = column.before + r - reach;
  auto best = hn::Add(hn::LoadU(d, before), hn::Set(d, column.penalty[0]));
  auto from = hn::Set(whole, -static_cast<std::int32_t>(reach));
  for (std::size_t k = 1; k < steps; ++k) {
    const auto candidate = hn::Add(hn::LoadU(d, before + k), hn::Set(d, column.penalty[k]));
    const auto away = hn::Set(whole, static_cast<std::int32_t>(k) - static_cast<std::int32_t>(reach));
    from = hn::IfThenElse(hn::RebindMask(whole, hn::Lt(candidate, best)), away, from);
    best = hn::Min(candidate, best);
  }
  hn::StoreU(hn::Min(hn::Set(d, column.most), hn::Add(best, hn::LoadU(d, column.own + r))), d, total + r);
  hn::StoreU(hn::TruncateTo(narrow, hn::BitCast(bits, from)), narrow,
             reinterpret_cast<std::uint8_t*>(step + r));
}

template <std::size_t Steps>
HWY_INLINE void step_all_rows(const ColumnStep& column, std::span<float> total, std::int8_t* step) {
  for_lanes(total.size(), [&](auto d, std::size_t r) { step_rows<Steps>(d, column, r, total.data(), step); });
}

void step_column_lanes(const ColumnStep& column, std::span<float> total, std::int8_t* step) {
  // The steps of the ridge's own path are unrolled.
  column.penalty.size() == 7 ? step_all_rows<7>(column, total, step) : step_all_rows<0>(column, total, step);
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::bite_line
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::bite_line {

HWY_EXPORT(convolve_lanes);
HWY_EXPORT(curvatures_lanes);
HWY_EXPORT(fit_lines_lanes);
HWY_EXPORT(fit_rows_lanes);
HWY_EXPORT(land_all);
HWY_EXPORT(slope_angles_lanes);
HWY_EXPORT(step_column_lanes);
HWY_EXPORT(sum_rows_simd);

std::vector<float> gaussian(double sigma_steps, double sigmas) {
  const int reach = static_cast<int>(std::ceil(sigmas * sigma_steps));
  std::vector<float> weights;
  for (int j = -reach; j <= reach; ++j)
    weights.push_back(static_cast<float>(std::exp(-0.5 * std::pow(j / sigma_steps, 2))));
  return weights;
}

void sum_rows(std::span<float> to, std::span<const WeightedRow> taps) {
  HWY_DYNAMIC_DISPATCH(sum_rows_simd)(to, taps);
}
void convolve(std::span<float> to, const float* from, std::span<const float> kernel) {
  HWY_DYNAMIC_DISPATCH(convolve_lanes)(to, from, kernel);
}
void fit_lines(const LineSums& sums, const LineFit& fit, std::span<float> to, std::uint8_t* known) {
  HWY_DYNAMIC_DISPATCH(fit_lines_lanes)(sums, fit, to, known);
}
void fit_rows(std::span<const RowOfSums> rows, const LineFit& fit, std::span<float> to, std::uint8_t* known) {
  HWY_DYNAMIC_DISPATCH(fit_rows_lanes)(rows, fit, to, known);
}
void slope_angles(std::span<float> to, const float* low, const float* high, float per_span) {
  HWY_DYNAMIC_DISPATCH(slope_angles_lanes)(to, low, high, per_span);
}
void curvatures(std::span<float> to, const float* from, float per_mm) {
  HWY_DYNAMIC_DISPATCH(curvatures_lanes)(to, from, per_mm);
}
void land(std::span<Landing> to, std::span<const OutlinePlace> places, const PathGrid& grid) {
  HWY_DYNAMIC_DISPATCH(land_all)(to, places, grid);
}
void step_column(const ColumnStep& column, std::span<float> total, std::int8_t* step) {
  HWY_DYNAMIC_DISPATCH(step_column_lanes)(column, total, step);
}

}  // namespace biteline::bite_line
#endif  // HWY_ONCE
