// SPDX-License-Identifier: MIT
#include "host/bite_line/published/solvers.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/bite_line/published/solvers.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "host/cloud/curvature/quadric-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace biteline::published {
namespace HWY_NAMESPACE {

using namespace curvature::HWY_NAMESPACE;
using curvature::Batch;

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

/// The published form: all eleven columns of [M | -b] noisy.
HWY_INLINE Quadric solve_pca(const Sums& sums) {
  Symmetric<k_columns + 1> full;
  for (std::size_t i = 0; i < k_columns; ++i) {
    for (std::size_t j = 0; j <= i; ++j) full.at(i, j) = sums.gram.at(i, j);
    full.at(k_columns, i) = hn::Neg(sums.gram_b[i]);
  }
  full.at(k_columns, k_columns) = sums.gram_bb;
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

/// Weights fall with the neighbour's residual too.  f at each neighbour against twice its root
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

void fit_weighted_pca_lanes(Batch& batch, float offset) {
  for (std::size_t lane = 0; lane < Batch::k_lanes; lane += hn::Lanes(D())) {
    const Rows rows = level_rows(batch, lane, offset);
    const Quadric first = solve_pca(sums_of(rows));
    weigh_by_residual(batch.scratch[0].data(), rows.count, first);
    store_curvature(solve_pca(sums_of(rows)), batch, lane);
  }
}

void fit_plain_svd_lanes(Batch& batch) {
  const D d;
  const std::size_t stride = hn::Lanes(d);
  float* m = batch.scratch[0].data();
  for (std::size_t lane = 0; lane < Batch::k_lanes; lane += stride) {
    const V count = load(batch.count, lane);
    V nx = hn::Zero(d);
    V ny = hn::Zero(d);
    V nz = set(1e-6F);
    for (std::size_t j = 0; j < batch.rows; ++j) {
      const V x = load(batch.x[j], lane);
      const V y = load(batch.y[j], lane);
      const V z = load(batch.z[j], lane);
      const V one = row_weight(count, j, x, y, z, 0.0F);
      monomials(x, y, z, one, m + j * k_columns * stride, stride);
      nx = hn::MulAdd(one, load(batch.nx[j], lane), nx);
      ny = hn::MulAdd(one, load(batch.ny[j], lane), ny);
      nz = hn::MulAdd(one, load(batch.nz[j], lane), nz);
    }
    Sums sums = sums_of({m, batch.rows, false, set(0.0F)});
    store_curvature(solve_homogeneous(sums.gram, nx, ny, nz), batch, lane);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::published
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::published {

HWY_EXPORT(fit_weighted_pca_lanes);
HWY_EXPORT(fit_plain_svd_lanes);

void fit_level_sets(curvature::Batch& batch, Solver solver, float offset) {
  switch (solver) {
    case Solver::WeightedPca:
      return HWY_DYNAMIC_DISPATCH(fit_weighted_pca_lanes)(batch, offset);
    case Solver::PlainSvd:
      return HWY_DYNAMIC_DISPATCH(fit_plain_svd_lanes)(batch);
    case Solver::LeastSquares:
      return curvature::fit_level_sets(batch, offset);
  }
}

}  // namespace biteline::published
#endif  // HWY_ONCE
