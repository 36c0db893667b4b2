// SPDX-License-Identifier: MIT
#include "host/geometry/symmetric.hpp"

#include <Eigen/Eigenvalues>

namespace biteline::geometry {

SymmetricSolver::SymmetricSolver(const AnyMatrix& A) : ldlt_{A} {}

bool SymmetricSolver::sound() const {
  return ldlt_.info() == Eigen::Success;
}

Eigen::MatrixXd SymmetricSolver::solve(const AnyMatrix& B) const {
  return ldlt_.solve(B);
}

Eigen::MatrixXd SymmetricSolver::inverse() const {
  return solve(Eigen::MatrixXd::Identity(ldlt_.rows(), ldlt_.cols()));
}

Eigen::MatrixXd solve_symmetric(const AnyMatrix& A, const AnyMatrix& B) {
  return SymmetricSolver{A}.solve(B);
}

PrincipalAxes principal_axes(const AnyMatrix& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver{A};
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors()};
}

}  // namespace biteline::geometry
