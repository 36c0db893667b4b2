// SPDX-License-Identifier: MIT
/// \file What the fits share for each instruction set: included once per target by Highway's foreach_target,
/// hence no
/// `#pragma once` but Highway's toggle.
#if defined(BITELINE_CURVATURE_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITELINE_CURVATURE_LANES_INL
#undef BITELINE_CURVATURE_LANES_INL
#else
#define BITELINE_CURVATURE_LANES_INL
#endif

#include <hwy/highway.h>

#include "host/cloud/curvature/batch.hpp"

HWY_BEFORE_NAMESPACE();
namespace biteline::curvature {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
// At most eight lanes: wider vectors gain nothing here, the fits are bound by the first-level cache.
using D = hn::CappedTag<float, 8>;
using V = hn::Vec<D>;

HWY_INLINE V load(const Batch::Row& row, std::size_t lane) {
  return hn::Load(D(), row.data() + lane);
}
HWY_INLINE void store(V v, Batch::Row& row, std::size_t lane) {
  hn::Store(v, D(), row.data() + lane);
}
HWY_INLINE V set(float value) {
  return hn::Set(D(), value);
}

/// exp(-fall d^2) as the eighth power of a short series' reciprocal: to 0.1 % over the neighbourhood.
HWY_INLINE V weight_of(V x, V y, V z, float fall) {
  const V one = set(1.0F);
  const V t = hn::Mul(set(0.125F * fall), hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))));
  const V series = hn::MulAdd(t, hn::MulAdd(t, hn::MulAdd(t, set(1.0F / 6), set(0.5F)), one), one);
  const V e = hn::Div(one, series);
  const V e2 = hn::Mul(e, e);
  const V e4 = hn::Mul(e2, e2);
  return hn::Mul(e4, e4);
}

/// Weight of row j: 0 in lanes that have no j-th neighbour.
HWY_INLINE V row_weight(V count, std::size_t j, V x, V y, V z, float fall) {
  return hn::IfThenElseZero(hn::Gt(count, set(static_cast<float>(j))), weight_of(x, y, z, fall));
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::curvature
HWY_AFTER_NAMESPACE();
#endif
