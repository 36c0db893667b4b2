// SPDX-License-Identifier: MIT
#include "host/curvature/batch.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/curvature/quadrics.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "host/curvature/lanes-inl.hpp"

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

/// Eigenvector of the least eigenvalue by inverse iteration; the eigenvalue is tiny against the next one
/// here, so three steps are plenty.
template <std::size_t N>
HWY_INLINE void least_eigenvector(Symmetric<N>& a, V (&x)[N]) {
  for (std::size_t i = 0; i < N; ++i) a.at(i, i) = hn::Add(a.at(i, i), set(1e-7F));
  decompose(a);
  for (int step = 0; step < 4; ++step) {
    solve(a, x);
    V norm2 = set(1e-12F);
    V largest = set(1e-12F);
    for (std::size_t i = 0; i < N; ++i) largest = hn::Max(largest, hn::Abs(x[i]));
    const V scale = hn::Div(set(1.0F), largest);
    for (std::size_t i = 0; i < N; ++i) {
      x[i] = hn::Mul(x[i], scale);
      // Components far below the largest one are zero: their squares would only underflow.
      x[i] = hn::IfThenElse(hn::Lt(hn::Abs(x[i]), set(1e-15F)), hn::Zero(D()), x[i]);
      norm2 = hn::MulAdd(x[i], x[i], norm2);
    }
    const V inverse = hn::Div(set(1.0F), hn::Sqrt(norm2));
    for (std::size_t i = 0; i < N; ++i) x[i] = hn::Mul(x[i], inverse);
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

/// The article's form: all eleven columns of [M | -b] noisy.
HWY_INLINE Quadric solve_pca(Symmetric<k_columns>& gram, const V (&gram_b)[k_columns], V gram_bb) {
  Symmetric<k_columns + 1> full;
  for (std::size_t i = 0; i < k_columns; ++i) {
    for (std::size_t j = 0; j <= i; ++j) full.at(i, j) = gram.at(i, j);
    full.at(k_columns, i) = hn::Neg(gram_b[i]);
  }
  full.at(k_columns, k_columns) = gram_bb;
  V x[k_columns + 1];
  for (std::size_t i = 0; i < k_columns; ++i) x[i] = hn::Zero(D());
  x[k_columns] = set(1.0F);
  least_eigenvector(full, x);
  Quadric quadric;
  const V last = hn::Abs(x[k_columns]);
  quadric.trust = hn::IfThenElse(hn::Gt(last, set(0.02F)), set(1.0F), hn::Zero(D()));
  const V safe = hn::IfThenElse(hn::Lt(x[k_columns], hn::Zero(D())), hn::Min(x[k_columns], set(-0.02F)),
                                hn::Max(x[k_columns], set(0.02F)));
  for (std::size_t i = 0; i < k_columns; ++i) quadric.a[i] = hn::Div(x[i], safe);
  return quadric;
}

/// Exact columns (constant and b) are eliminated first, by their Schur complement; total least squares on the
/// other nine.
HWY_INLINE Quadric solve_mixed(Symmetric<k_columns>& gram, const V (&gram_b)[k_columns], V gram_bb) {
  constexpr std::size_t k_noisy = 9;
  // E = [[c, -e], [-e, f]] over (constant, -b); e = gram_b of the constant.
  const V c = gram.at(9, 9);
  const V e = hn::Neg(gram_b[9]);
  const V det = hn::Max(hn::NegMulAdd(e, e, hn::Mul(c, gram_bb)), set(1e-9F));
  const V inverse = hn::Div(set(1.0F), det);
  const V i00 = hn::Mul(gram_bb, inverse);
  const V i01 = hn::Neg(hn::Mul(e, inverse));
  const V i11 = hn::Mul(c, inverse);
  Symmetric<k_noisy> schur;
  V to_constant[k_noisy];
  V to_b[k_noisy];
  for (std::size_t i = 0; i < k_noisy; ++i) {
    const V u = gram.at(9, i);
    const V v = hn::Neg(gram_b[i]);
    to_constant[i] = hn::MulAdd(i00, u, hn::Mul(i01, v));
    to_b[i] = hn::MulAdd(i01, u, hn::Mul(i11, v));
  }
  for (std::size_t i = 0; i < k_noisy; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const V lost = hn::MulAdd(gram.at(9, i), to_constant[j], hn::Mul(hn::Neg(gram_b[i]), to_b[j]));
      schur.at(i, j) = hn::Sub(gram.at(i, j), lost);
    }
  }
  V x[k_noisy];
  // The gradient dominates: start from all three of its directions.
  for (std::size_t i = 0; i < k_noisy; ++i)
    x[i] = i < 6 ? hn::Zero(D()) : set(i == 6 ? 0.6F : i == 7 ? 0.55F : 0.58F);
  least_eigenvector(schur, x);
  V constant = hn::Zero(D());
  V last = hn::Zero(D());
  for (std::size_t i = 0; i < k_noisy; ++i) {
    constant = hn::NegMulAdd(to_constant[i], x[i], constant);
    last = hn::NegMulAdd(to_b[i], x[i], last);
  }
  Quadric quadric;
  quadric.trust = hn::IfThenElse(hn::Gt(hn::Abs(last), set(0.02F)), set(1.0F), hn::Zero(D()));
  const V safe =
      hn::IfThenElse(hn::Lt(last, hn::Zero(D())), hn::Min(last, set(-0.02F)), hn::Max(last, set(0.02F)));
  for (std::size_t i = 0; i < k_noisy; ++i) quadric.a[i] = hn::Div(x[i], safe);
  quadric.a[9] = hn::Div(constant, safe);
  return quadric;
}

/// f = 0 on the points alone: defined up to its sign and size, of which the normals settle the sign.
HWY_INLINE Quadric solve_homogeneous(Symmetric<k_columns>& gram, V nx, V ny, V nz) {
  Quadric quadric;
  for (std::size_t i = 0; i < k_columns; ++i) quadric.a[i] = hn::Zero(D());
  quadric.a[6] = nx;
  quadric.a[7] = ny;
  quadric.a[8] = nz;
  least_eigenvector(gram, quadric.a);
  const V along = hn::MulAdd(quadric.a[6], nx, hn::MulAdd(quadric.a[7], ny, hn::Mul(quadric.a[8], nz)));
  // To unit slope, as the levels of the other forms have it; where there is no slope there is no surface.
  const V slope2 =
      hn::MulAdd(quadric.a[6], quadric.a[6],
                 hn::MulAdd(quadric.a[7], quadric.a[7], hn::MulAdd(quadric.a[8], quadric.a[8], set(1e-8F))));
  const V scale =
      hn::Div(hn::IfThenElse(hn::Lt(along, hn::Zero(D())), set(-1.0F), set(1.0F)), hn::Sqrt(slope2));
  for (V& a : quadric.a) a = hn::Mul(a, scale);
  quadric.trust = set(1.0F);
  return quadric;
}

HWY_INLINE Quadric solve_least_squares(Symmetric<k_columns>& gram, const V (&gram_b)[k_columns]) {
  Quadric quadric;
  for (std::size_t i = 0; i < k_columns; ++i) {
    quadric.a[i] = gram_b[i];
    gram.at(i, i) = hn::Add(gram.at(i, i), set(1e-7F));
  }
  decompose(gram);
  solve(gram, quadric.a);
  quadric.trust = set(1.0F);
  return quadric;
}

/// What the rows of one lane group stand for.
struct Levels {
  bool used;  ///< three rows per neighbour, at 0, +c and -c; else one
  V c;        ///< offset, in radii
  V mean_nx, mean_ny, mean_nz;
  [[nodiscard]] std::size_t rows_each() const { return used ? 3 : 1; }
};

/// The quadric through weighted rows of monomials.
HWY_INLINE Quadric fit_quadric(const float* m, std::size_t rows, const Levels& levels, Solver solver) {
  const D d;
  const std::size_t stride = hn::Lanes(d);
  Symmetric<k_columns> gram;
  gram_tile<0, 0>(m, rows, stride, gram);
  gram_tile<3, 0>(m, rows, stride, gram);
  gram_tile<3, 3>(m, rows, stride, gram);
  gram_tile<6, 0>(m, rows, stride, gram);
  gram_tile<6, 3>(m, rows, stride, gram);
  gram_tile<6, 6>(m, rows, stride, gram);
  V constant[k_columns];
  V gram_b[k_columns];
  for (std::size_t i = 0; i < k_columns; ++i) constant[i] = gram_b[i] = hn::Zero(d);
  for (std::size_t r = 0; r < rows; ++r) {
    const float* row = m + r * k_columns * stride;
    const V one = hn::Load(d, row + 9 * stride);
    for (std::size_t i = 0; i < k_columns; ++i)
      constant[i] = hn::MulAdd(one, hn::Load(d, row + i * stride), constant[i]);
  }
  V outer_weight = hn::Zero(d);
  for (std::size_t j = 0; levels.used && j < rows / 3; ++j) {
    const float* above = m + (3 * j + 1) * k_columns * stride;
    const float* below = above + k_columns * stride;
    const V one = hn::Mul(levels.c, hn::Load(d, above + 9 * stride));
    outer_weight = hn::MulAdd(hn::Add(one, one), one, outer_weight);
    for (std::size_t i = 0; i < k_columns; ++i) {
      gram_b[i] = hn::MulAdd(one, hn::Sub(hn::Load(d, above + i * stride), hn::Load(d, below + i * stride)),
                             gram_b[i]);
    }
  }
  for (std::size_t i = 0; i < k_columns; ++i) gram.at(9, i) = constant[i];
  // Weights sum to one from here on, so that the thresholds of the solvers mean the same for any number of
  // neighbours.
  const V share = hn::Div(set(static_cast<float>(levels.rows_each())), hn::Max(constant[9], set(1e-6F)));
  for (V& entry : gram.entry) entry = hn::Mul(entry, share);
  for (V& entry : gram_b) entry = hn::Mul(entry, share);
  outer_weight = hn::Mul(outer_weight, share);

  Quadric q;
  switch (solver) {
    case Solver::PlainSvd:
      q = solve_homogeneous(gram, levels.mean_nx, levels.mean_ny, levels.mean_nz);
      break;
    case Solver::WeightedPca:
      q = solve_pca(gram, gram_b, outer_weight);
      break;
    case Solver::Mixed:
      q = solve_mixed(gram, gram_b, outer_weight);
      break;
    case Solver::LeastSquares:
      q = solve_least_squares(gram, gram_b);
      break;
  }
  return q;
}

/// method.md 7: weights fall with the neighbour's residual too.  f at each neighbour against twice its root
/// mean square (Cauchy), in place: all three rows of a neighbour are scaled by the root of its new weight.
HWY_INLINE void weigh_by_residual(float* m, std::size_t rows, const Quadric& quadric) {
  constexpr float k_scale2 = 4.0F;
  const D d;
  const std::size_t stride = hn::Lanes(d);
  const auto residual = [&](std::size_t r) {
    const float* row = m + r * k_columns * stride;
    V sum = hn::Zero(d);
    for (std::size_t i = 0; i < k_columns; ++i)
      sum = hn::MulAdd(quadric.a[i], hn::Load(d, row + i * stride), sum);
    return sum;
  };
  V squares = hn::Zero(d);
  V weights = set(1e-6F);
  for (std::size_t r = 0; r < rows; r += 3) {
    const V root_weight = hn::Load(d, m + (r * k_columns + 9) * stride);
    const V f = residual(r);
    squares = hn::MulAdd(f, f, squares);
    weights = hn::MulAdd(root_weight, root_weight, weights);
  }
  // A thousandth of the radius is as good as a perfect fit.
  const V scale2 = hn::Max(hn::Mul(set(k_scale2), hn::Div(squares, weights)), set(1e-6F));
  for (std::size_t r = 0; r < rows; r += 3) {
    const V root_weight = hn::Max(hn::Load(d, m + (r * k_columns + 9) * stride), set(1e-6F));
    const V f = hn::Div(residual(r), root_weight);
    const V scale = hn::Sqrt(hn::Div(scale2, hn::MulAdd(f, f, scale2)));
    for (std::size_t i = 0; i < 3 * k_columns; ++i) {
      float* entry = m + (r * k_columns + i) * stride;
      hn::Store(hn::Mul(scale, hn::Load(d, entry)), d, entry);
    }
  }
}

void FitLevelSets(Batch& batch, Solver solver, float offset) {
  const D d;
  const std::size_t stride = hn::Lanes(d);
  float* m = batch.scratch[0].data();
  for (std::size_t lane = 0; lane < Batch::k_lanes; lane += stride) {
    const V count = load(batch.count, lane);
    const bool levels = solver != Solver::PlainSvd;
    const std::size_t rows_each = levels ? 3 : 1;
    const float fall = levels ? batch.fall : 0.0F;
    V mean_nx = hn::Zero(d);
    V mean_ny = hn::Zero(d);
    V mean_nz = set(1e-6F);
    const V c = set(offset);
    for (std::size_t j = 0; j < batch.rows; ++j) {
      const V x = load(batch.x[j], lane);
      const V y = load(batch.y[j], lane);
      const V z = load(batch.z[j], lane);
      const V r = hn::Sqrt(row_weight(count, j, x, y, z, fall));
      const V ox = hn::Mul(c, load(batch.nx[j], lane));
      const V oy = hn::Mul(c, load(batch.ny[j], lane));
      const V oz = hn::Mul(c, load(batch.nz[j], lane));
      float* row = m + rows_each * j * k_columns * stride;
      monomials(x, y, z, r, row, stride);
      if (!levels) {
        mean_nx = hn::MulAdd(r, ox, mean_nx);
        mean_ny = hn::MulAdd(r, oy, mean_ny);
        mean_nz = hn::MulAdd(r, oz, mean_nz);
        continue;
      }
      monomials(hn::Add(x, ox), hn::Add(y, oy), hn::Add(z, oz), r, row + k_columns * stride, stride);
      monomials(hn::Sub(x, ox), hn::Sub(y, oy), hn::Sub(z, oz), r, row + 2 * k_columns * stride, stride);
    }
    const std::size_t rows = rows_each * batch.rows;
    const Levels with{.used = levels, .c = c, .mean_nx = mean_nx, .mean_ny = mean_ny, .mean_nz = mean_nz};
    Quadric q = fit_quadric(m, rows, with, solver);
    if (solver == Solver::WeightedPca) {
      weigh_by_residual(m, rows, q);
      q = fit_quadric(m, rows, with, solver);
    }
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
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::curvature
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::curvature {

HWY_EXPORT(FitLevelSets);

void fit_level_sets(Batch& batch, Solver solver, float offset) {
  HWY_DYNAMIC_DISPATCH(FitLevelSets)(batch, solver, offset);
}

}  // namespace biteline::curvature
#endif  // HWY_ONCE
