// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/tool_touch.hpp"

#include <algorithm>
#include <cmath>

#include "common/csv/table.hpp"
#include "host/geometry/symmetric.hpp"
#include "host/robot/kinematics/student.hpp"

namespace biteline::kinematics {
namespace {

constexpr std::size_t k_least_tip_touches = 4;
// Smallest singular value of the rotations' part per square root of touches: 0.1 is a spread of about 6
// degrees.
constexpr double k_least_spread = 0.1;

}  // namespace

Result<ToolTouch> fit_tool_touch(std::span<const SE3> T_base_flange, const ToolTouchLimits& limits) {
  const std::size_t n = T_base_flange.size();
  if (n < k_least_tip_touches)
    return fail(Errc::Degenerate, "tool touch: %zu touches, at least %zu needed", n, k_least_tip_touches);
  const auto rows = static_cast<Eigen::Index>(3 * n);
  Eigen::MatrixXd A(rows, 6);
  Eigen::VectorXd b(rows);
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    A.block<3, 3>(row, 0) = T_base_flange[i].linear();
    A.block<3, 3>(row, 3) = -Mat3::Identity();
    b.segment<3>(row) = -T_base_flange[i].translation();
  }
  // Of the normal equations: the rotations' entries are at most 1, and the spread is 0.1 at least.
  const Eigen::MatrixXd normal = A.transpose() * A;
  const double spread =
      std::sqrt(std::max(0.0, geometry::principal_axes(normal).values[0]) / static_cast<double>(n));
  if (spread < k_least_spread) {
    return fail(
        Errc::Degenerate,
        "tool touch: orientations too much alike (spread %.3f, at least %.1f); touch from other sides",
        spread, k_least_spread);
  }
  const geometry::SymmetricSolver solver{normal};
  const Eigen::VectorXd x = solver.solve(A.transpose() * b);
  const Eigen::VectorXd left = A * x - b;

  ToolTouch out{.tip_flange = x.head<3>(),
                .sigma_mm = Vec3::Zero(),
                .u95_mm = 0,
                .point_base = x.tail<3>(),
                .rms_mm = 0,
                .residual_mm = {},
                .worst = 0};
  for (std::size_t i = 0; i < n; ++i)
    out.residual_mm.push_back(left.segment<3>(static_cast<Eigen::Index>(3 * i)).norm());
  out.worst = static_cast<std::size_t>(std::ranges::max_element(out.residual_mm) - out.residual_mm.begin());
  out.rms_mm = std::sqrt(left.squaredNorm() / static_cast<double>(n));
  // Covariance of linear least squares: s^2 (A^T A)^-1 with 3 n - 6 degrees of freedom.
  const double variance_mm2 = left.squaredNorm() / static_cast<double>(rows - 6);
  const Eigen::MatrixXd covariance = variance_mm2 * solver.inverse();
  for (int axis = 0; axis < 3; ++axis) out.sigma_mm[axis] = std::sqrt(std::max(0.0, covariance(axis, axis)));
  const double most_mm2 = geometry::principal_axes(covariance.topLeftCorner(3, 3)).values[2];
  out.u95_mm = student_95(static_cast<int>(rows - 6)) * std::sqrt(std::max(0.0, most_mm2));

  if (out.rms_mm > limits.max_rms_mm) {
    return fail(
        Errc::CheckFailed,
        "tool touch: the tips are %.2f mm RMS off one point (limit %.2f), touch %zu worst with %.2f mm",
        out.rms_mm, limits.max_rms_mm, out.worst, out.residual_mm[out.worst]);
  }
  if (out.sigma_mm.maxCoeff() > limits.max_sigma_mm) {
    return fail(Errc::Degenerate, "tool touch: tip known to %.2f mm only (limit %.2f); touch from more sides",
                out.sigma_mm.maxCoeff(), limits.max_sigma_mm);
  }
  return out;
}

Result<std::vector<SE3>> read_touches(const std::filesystem::path& file) {
  std::vector<SE3> touches;
  BITELINE_TRY(csv::read_table(file, 8, 8, [&](const csv::Row& row) -> Result<void> {
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      BITELINE_ASSIGN(v[i], row.number(i + 1));
    }
    const Eigen::Quaterniond q{v[3], v[4], v[5], v[6]};
    if (std::abs(q.norm() - 1) > 1e-3)
      return fail(Errc::BadValue, "%s row %d: a unit quaternion expected", file.c_str(), row.number());
    touches.push_back(geometry::make_se3(q, Vec3{v[0], v[1], v[2]}));
    return {};
  }));
  return touches;
}

}  // namespace biteline::kinematics
