// SPDX-License-Identifier: MIT
#pragma once
/// \file Symmetric matrices of any size: equations solved and principal axes found, by code that is compiled
/// once. Eigen's own make new code for each size in each unit that names them, seconds of compilation each
/// time. Where nanoseconds count, or a matrix has at most three rows, use them directly.

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace biteline::geometry {

using AnyMatrix = Eigen::Ref<const Eigen::MatrixXd>;

/// A X = B for a symmetric A, definite or not, by LDLT.
class SymmetricSolver {
 public:
  explicit SymmetricSolver(const AnyMatrix& A);
  /// Whether A could be decomposed.  solve() leaves out the directions in which a singular A says nothing.
  [[nodiscard]] bool sound() const;
  [[nodiscard]] Eigen::MatrixXd solve(const AnyMatrix& B) const;
  [[nodiscard]] Eigen::MatrixXd inverse() const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> ldlt_;
};
/// The same for one right side.
[[nodiscard]] Eigen::MatrixXd solve_symmetric(const AnyMatrix& A, const AnyMatrix& B);

/// Eigenvalues, the least first, and unit eigenvectors in the columns beside them.
struct PrincipalAxes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
[[nodiscard]] PrincipalAxes principal_axes(const AnyMatrix& A);

}  // namespace biteline::geometry
