// SPDX-License-Identifier: MIT
#include "host/cloud/curvature/batch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cloud/curvature/planes.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "host/cloud/curvature/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace biteline::curvature {
namespace HWY_NAMESPACE {

/// One Jacobi rotation that clears a_pq; r is the third index.  Golub and Van Loan, Matrix
/// Computations, 8.5.2.
HWY_INLINE void rotate(V& app, V& aqq, V& apq, V& apr, V& aqr, V (&vp)[3], V (&vq)[3]) {
  // Entries far below the diagonal are zero: their squares would only underflow.
  const V small = set(1e-9F);
  apq = hn::IfThenElse(hn::Lt(hn::Abs(apq), small), hn::Zero(D()), apq);
  const V d = hn::Sub(aqq, app);
  const V two = hn::Add(apq, apq);
  const V root = hn::Sqrt(hn::MulAdd(d, d, hn::Mul(two, two)));
  const V denominator = hn::Add(hn::Abs(d), root);
  const V safe = hn::Max(denominator, set(1e-9F));
  V t = hn::Div(two, safe);
  t = hn::IfThenElse(hn::Lt(d, hn::Zero(D())), hn::Neg(t), t);
  const V c = hn::Div(set(1.0F), hn::Sqrt(hn::MulAdd(t, t, set(1.0F))));
  const V s = hn::Mul(t, c);
  app = hn::NegMulAdd(t, apq, app);
  aqq = hn::MulAdd(t, apq, aqq);
  apq = hn::Zero(D());
  const V pr = hn::Sub(hn::Mul(c, apr), hn::Mul(s, aqr));
  aqr = hn::MulAdd(s, apr, hn::Mul(c, aqr));
  apr = pr;
  for (int i = 0; i < 3; ++i) {
    const V p = hn::Sub(hn::Mul(c, vp[i]), hn::Mul(s, vq[i]));
    vq[i] = hn::MulAdd(s, vp[i], hn::Mul(c, vq[i]));
    vp[i] = p;
  }
}

void fit_planes_lanes(Batch& batch) {
  const D d;
  for (std::size_t lane = 0; lane < Batch::k_lanes; lane += hn::Lanes(d)) {
    const V zero = hn::Zero(d);
    const V count = load(batch.count, lane);
    V w = zero, sx = zero, sy = zero, sz = zero, xx = zero, yy = zero, zz = zero, xy = zero, xz = zero,
      yz = zero;
    for (std::size_t j = 0; j < batch.rows; ++j) {
      const V x = load(batch.x[j], lane);
      const V y = load(batch.y[j], lane);
      const V z = load(batch.z[j], lane);
      const V weight = row_weight(count, j, x, y, z, batch.fall);
      const V wx = hn::Mul(weight, x);
      const V wy = hn::Mul(weight, y);
      const V wz = hn::Mul(weight, z);
      w = hn::Add(w, weight);
      sx = hn::Add(sx, wx);
      sy = hn::Add(sy, wy);
      sz = hn::Add(sz, wz);
      xx = hn::MulAdd(wx, x, xx);
      yy = hn::MulAdd(wy, y, yy);
      zz = hn::MulAdd(wz, z, zz);
      xy = hn::MulAdd(wx, y, xy);
      xz = hn::MulAdd(wx, z, xz);
      yz = hn::MulAdd(wy, z, yz);
    }
    const V inverse = hn::Div(set(1.0F), hn::Max(w, set(1e-6F)));
    const V mx = hn::Mul(sx, inverse);
    const V my = hn::Mul(sy, inverse);
    const V mz = hn::Mul(sz, inverse);
    V a00 = hn::NegMulAdd(mx, mx, hn::Mul(xx, inverse));
    V a11 = hn::NegMulAdd(my, my, hn::Mul(yy, inverse));
    V a22 = hn::NegMulAdd(mz, mz, hn::Mul(zz, inverse));
    V a01 = hn::NegMulAdd(mx, my, hn::Mul(xy, inverse));
    V a02 = hn::NegMulAdd(mx, mz, hn::Mul(xz, inverse));
    V a12 = hn::NegMulAdd(my, mz, hn::Mul(yz, inverse));
    const V one = set(1.0F);
    V v0[3] = {one, zero, zero};
    V v1[3] = {zero, one, zero};
    V v2[3] = {zero, zero, one};
    for (int sweep = 0; sweep < 4; ++sweep) {
      rotate(a00, a11, a01, a02, a12, v0, v1);
      rotate(a00, a22, a02, a01, a12, v0, v2);
      rotate(a11, a22, a12, a01, a02, v1, v2);
    }
    const auto first = hn::And(hn::Le(a00, a11), hn::Le(a00, a22));
    const auto second = hn::Le(a11, a22);
    V n[3];
    for (int i = 0; i < 3; ++i) n[i] = hn::IfThenElse(first, v0[i], hn::IfThenElse(second, v1[i], v2[i]));
    store(n[0], batch.out_nx, lane);
    store(n[1], batch.out_ny, lane);
    store(n[2], batch.out_nz, lane);
  }
}

const char* target_lanes() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::curvature
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::curvature {

HWY_EXPORT(fit_planes_lanes);
HWY_EXPORT(target_lanes);

void fit_planes(Batch& batch) {
  HWY_DYNAMIC_DISPATCH(fit_planes_lanes)(batch);
}
const char* vector_target() {
  return HWY_DYNAMIC_DISPATCH(target_lanes)();
}

}  // namespace biteline::curvature
#endif  // HWY_ONCE
