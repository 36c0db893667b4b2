// SPDX-License-Identifier: MIT
/// \file The quadric through many neighbourhoods at once: rows, their sums, and the curvature of the level
/// set. Included once per target by Highway's foreach_target, hence no `#pragma once` but Highway's toggle.
#if defined(BITELINE_CURVATURE_QUADRIC_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITELINE_CURVATURE_QUADRIC_INL
#undef BITELINE_CURVATURE_QUADRIC_INL
#else
#define BITELINE_CURVATURE_QUADRIC_INL
#endif

#include <hwy/highway.h>

#include "host/cloud/curvature/batch.hpp"
#include "host/cloud/curvature/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace biteline::curvature {
namespace HWY_NAMESPACE {

constexpr std::size_t k_columns = 10;

/// Lower triangle of a symmetric matrix of size N, by rows.
template <std::size_t N>
struct Symmetric {
  V entry[N * (N + 1) / 2];
  HWY_INLINE V& at(std::size_t row, std::size_t col) {
    return entry[row * (row + 1) / 2 + col];
  }  // pre: row >= col
  HWY_INLINE const V& at(std::size_t row, std::size_t col) const { return entry[row * (row + 1) / 2 + col]; }
};

/// In place A = L D L^T; the unit lower triangle replaces the strict one, 1 / D the diagonal.
template <std::size_t N>
HWY_INLINE void decompose(Symmetric<N>& a) {
  for (std::size_t j = 0; j < N; ++j) {
    V column[N];
    V diagonal = a.at(j, j);
    for (std::size_t k = 0; k < j; ++k) {
      // a(k,k) holds 1 / D_k; column[k] = L_jk D_k was kept when row j was reduced.
      column[k] = a.at(j, k);
      for (std::size_t i = 0; i < k; ++i) column[k] = hn::NegMulAdd(column[i], a.at(k, i), column[k]);
    }
    for (std::size_t k = 0; k < j; ++k) {
      const V l = hn::Mul(column[k], a.at(k, k));
      diagonal = hn::NegMulAdd(l, column[k], diagonal);
      a.at(j, k) = l;
    }
    // A pivot lost in rounding: the matrix is singular there; a tiny one keeps the lane finite.
    diagonal = hn::IfThenElse(hn::Lt(hn::Abs(diagonal), set(1e-9F)), set(1e-9F), diagonal);
    a.at(j, j) = hn::Div(set(1.0F), diagonal);
  }
}

template <std::size_t N>
HWY_INLINE void solve(Symmetric<N>& a, V (&x)[N]) {
  for (std::size_t j = 0; j < N; ++j) {
    for (std::size_t k = 0; k < j; ++k) x[j] = hn::NegMulAdd(a.at(j, k), x[k], x[j]);
  }
  for (std::size_t j = 0; j < N; ++j) x[j] = hn::Mul(x[j], a.at(j, j));
  for (std::size_t j = N; j-- > 0;) {
    for (std::size_t k = j + 1; k < N; ++k) x[j] = hn::NegMulAdd(a.at(k, j), x[k], x[j]);
  }
}

/// x^2 y^2 z^2 xy yz xz x y z 1, each times `r`.
HWY_INLINE void monomials(V x, V y, V z, V r, float* out, std::size_t stride) {
  const D d;
  const V rx = hn::Mul(r, x);
  const V ry = hn::Mul(r, y);
  const V rz = hn::Mul(r, z);
  hn::Store(hn::Mul(rx, x), d, out);
  hn::Store(hn::Mul(ry, y), d, out + stride);
  hn::Store(hn::Mul(rz, z), d, out + 2 * stride);
  hn::Store(hn::Mul(rx, y), d, out + 3 * stride);
  hn::Store(hn::Mul(ry, z), d, out + 4 * stride);
  hn::Store(hn::Mul(rx, z), d, out + 5 * stride);
  hn::Store(rx, d, out + 6 * stride);
  hn::Store(ry, d, out + 7 * stride);
  hn::Store(rz, d, out + 8 * stride);
  hn::Store(r, d, out + 9 * stride);
}

/// Three rows by three columns of the Gram matrix, kept in registers over all rows of M.
template <std::size_t I, std::size_t J>
HWY_INLINE void gram_tile(const float* m, std::size_t rows, std::size_t stride, Symmetric<k_columns>& gram) {
  const D d;
  V sum[3][3];
  for (auto& line : sum) {
    for (V& s : line) s = hn::Zero(d);
  }
  for (std::size_t r = 0; r < rows; ++r) {
    const float* row = m + r * k_columns * stride;
    const V j0 = hn::Load(d, row + J * stride);
    const V j1 = hn::Load(d, row + (J + 1) * stride);
    const V j2 = hn::Load(d, row + (J + 2) * stride);
    for (std::size_t i = 0; i < 3; ++i) {
      const V a = hn::Load(d, row + (I + i) * stride);
      sum[i][0] = hn::MulAdd(a, j0, sum[i][0]);
      sum[i][1] = hn::MulAdd(a, j1, sum[i][1]);
      sum[i][2] = hn::MulAdd(a, j2, sum[i][2]);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (I + i >= J + j) gram.at(I + i, J + j) = sum[i][j];
    }
  }
}

struct Quadric {
  V a[k_columns];
  V trust;
};

/// Sums over weighted rows of monomials: M^T M, M^T b and b^T b.
struct Sums {
  Symmetric<k_columns> gram;
  V gram_b[k_columns];
  V gram_bb;
};

/// Rows of one neighbourhood per lane: at the points (f = 0), and with `levels` also at +c and -c of each.
struct Rows {
  const float* m;
  std::size_t count;
  bool levels;
  V c;
};

HWY_INLINE Sums sums_of(const Rows& rows) {
  const D d;
  const std::size_t stride = hn::Lanes(d);
  Sums sums;
  gram_tile<0, 0>(rows.m, rows.count, stride, sums.gram);
  gram_tile<3, 0>(rows.m, rows.count, stride, sums.gram);
  gram_tile<3, 3>(rows.m, rows.count, stride, sums.gram);
  gram_tile<6, 0>(rows.m, rows.count, stride, sums.gram);
  gram_tile<6, 3>(rows.m, rows.count, stride, sums.gram);
  gram_tile<6, 6>(rows.m, rows.count, stride, sums.gram);
  V constant[k_columns];
  for (std::size_t i = 0; i < k_columns; ++i) constant[i] = sums.gram_b[i] = hn::Zero(d);
  for (std::size_t r = 0; r < rows.count; ++r) {
    const float* row = rows.m + r * k_columns * stride;
    const V one = hn::Load(d, row + 9 * stride);
    for (std::size_t i = 0; i < k_columns; ++i)
      constant[i] = hn::MulAdd(one, hn::Load(d, row + i * stride), constant[i]);
  }
  sums.gram_bb = hn::Zero(d);
  for (std::size_t j = 0; rows.levels && j < rows.count / 3; ++j) {
    const float* above = rows.m + (3 * j + 1) * k_columns * stride;
    const float* below = above + k_columns * stride;
    const V one = hn::Mul(rows.c, hn::Load(d, above + 9 * stride));
    sums.gram_bb = hn::MulAdd(hn::Add(one, one), one, sums.gram_bb);
    for (std::size_t i = 0; i < k_columns; ++i) {
      sums.gram_b[i] = hn::MulAdd(
          one, hn::Sub(hn::Load(d, above + i * stride), hn::Load(d, below + i * stride)), sums.gram_b[i]);
    }
  }
  for (std::size_t i = 0; i < k_columns; ++i) sums.gram.at(9, i) = constant[i];
  // Weights sum to one from here on, so that the thresholds of the solvers mean the same for any number of
  // neighbours.
  const V share = hn::Div(set(rows.levels ? 3.0F : 1.0F), hn::Max(constant[9], set(1e-6F)));
  for (V& entry : sums.gram.entry) entry = hn::Mul(entry, share);
  for (V& entry : sums.gram_b) entry = hn::Mul(entry, share);
  sums.gram_bb = hn::Mul(sums.gram_bb, share);
  return sums;
}

/// The rows of a batch's lanes from `lane` on, at the three levels, into its scratch.
HWY_INLINE Rows level_rows(Batch& batch, std::size_t lane, float offset) {
  const D d;
  const std::size_t stride = hn::Lanes(d);
  float* m = batch.scratch[0].data();
  const V count = load(batch.count, lane);
  const V c = set(offset);
  for (std::size_t j = 0; j < batch.rows; ++j) {
    const V x = load(batch.x[j], lane);
    const V y = load(batch.y[j], lane);
    const V z = load(batch.z[j], lane);
    const V r = hn::Sqrt(row_weight(count, j, x, y, z, batch.fall));
    const V ox = hn::Mul(c, load(batch.nx[j], lane));
    const V oy = hn::Mul(c, load(batch.ny[j], lane));
    const V oz = hn::Mul(c, load(batch.nz[j], lane));
    float* row = m + 3 * j * k_columns * stride;
    monomials(x, y, z, r, row, stride);
    monomials(hn::Add(x, ox), hn::Add(y, oy), hn::Add(z, oz), r, row + k_columns * stride, stride);
    monomials(hn::Sub(x, ox), hn::Sub(y, oy), hn::Sub(z, oz), r, row + 2 * k_columns * stride, stride);
  }
  return {m, 3 * batch.rows, true, c};
}

/// All columns taken as exact: least variance when the noise is small against the radius.
HWY_INLINE Quadric solve_least_squares(Sums& sums) {
  Quadric quadric;
  for (std::size_t i = 0; i < k_columns; ++i) {
    quadric.a[i] = sums.gram_b[i];
    sums.gram.at(i, i) = hn::Add(sums.gram.at(i, i), set(1e-7F));
  }
  decompose(sums.gram);
  solve(sums.gram, quadric.a);
  quadric.trust = set(1.0F);
  return quadric;
}

/// H and K of the level set through the point itself.
HWY_INLINE void store_curvature(const Quadric& q, Batch& batch, std::size_t lane) {
  const D d;
  const V gx = q.a[6], gy = q.a[7], gz = q.a[8];
  const V fxx = hn::Add(q.a[0], q.a[0]), fyy = hn::Add(q.a[1], q.a[1]), fzz = hn::Add(q.a[2], q.a[2]);
  const V fxy = q.a[3], fyz = q.a[4], fxz = q.a[5];
  const V g2 = hn::MulAdd(gx, gx, hn::MulAdd(gy, gy, hn::MulAdd(gz, gz, set(1e-12F))));
  const V g1 = hn::Sqrt(g2);
  // g^T F g
  const V fgx = hn::MulAdd(fxx, gx, hn::MulAdd(fxy, gy, hn::Mul(fxz, gz)));
  const V fgy = hn::MulAdd(fxy, gx, hn::MulAdd(fyy, gy, hn::Mul(fyz, gz)));
  const V fgz = hn::MulAdd(fxz, gx, hn::MulAdd(fyz, gy, hn::Mul(fzz, gz)));
  const V gfg = hn::MulAdd(gx, fgx, hn::MulAdd(gy, fgy, hn::Mul(gz, fgz)));
  const V trace = hn::Add(fxx, hn::Add(fyy, fzz));
  const V mean = hn::Div(hn::Sub(hn::Mul(g2, trace), gfg), hn::Mul(set(2.0F), hn::Mul(g2, g1)));
  // g^T adj(F) g
  const V c00 = hn::NegMulAdd(fyz, fyz, hn::Mul(fyy, fzz));
  const V c11 = hn::NegMulAdd(fxz, fxz, hn::Mul(fxx, fzz));
  const V c22 = hn::NegMulAdd(fxy, fxy, hn::Mul(fxx, fyy));
  const V c01 = hn::NegMulAdd(fxy, fzz, hn::Mul(fxz, fyz));
  const V c02 = hn::NegMulAdd(fxz, fyy, hn::Mul(fxy, fyz));
  const V c12 = hn::NegMulAdd(fxx, fyz, hn::Mul(fxy, fxz));
  const V agx = hn::MulAdd(c00, gx, hn::MulAdd(c01, gy, hn::Mul(c02, gz)));
  const V agy = hn::MulAdd(c01, gx, hn::MulAdd(c11, gy, hn::Mul(c12, gz)));
  const V agz = hn::MulAdd(c02, gx, hn::MulAdd(c12, gy, hn::Mul(c22, gz)));
  const V gag = hn::MulAdd(gx, agx, hn::MulAdd(gy, agy, hn::Mul(gz, agz)));
  const V gaussian = hn::Div(gag, hn::Mul(g2, g2));
  // The offset levels give f unit slope; far from it the fit has not followed them.
  const auto sane = hn::And(hn::Gt(g1, set(0.2F)), hn::Lt(g1, set(5.0F)));
  const V trust = hn::IfThenElse(sane, q.trust, hn::Zero(d));
  const auto trusted = hn::Gt(trust, hn::Zero(d));
  store(hn::IfThenElse(trusted, mean, hn::Zero(d)), batch.mean, lane);
  store(hn::IfThenElse(trusted, gaussian, hn::Zero(d)), batch.gaussian, lane);
  store(trust, batch.trust, lane);
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::curvature
HWY_AFTER_NAMESPACE();
#endif
