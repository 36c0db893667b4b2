// SPDX-License-Identifier: MIT
#include "host/calibration/handeye/pose_adjustment.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

using Mat6x12 = Eigen::Matrix<double, 6, 12>;

/// Below, a component of the noise is as good as none: a UR's encoders resolve some 1e-6 rad.
constexpr double k_least_sigma_mm = 5e-4, k_least_sigma_rad = 1e-6;

struct Linearised {
  Twist residual;
  Mat6x12 J;     ///< to [T_flange_cam; T_base_target] perturbed on the right
  Mat6 J_robot;  ///< to the flange's perturbation
};

Linearised linearise(const Stop& stop, const PoseAdjustment& at) {
  Linearised out;
  const SE3 T_target_flange = (at.T_flange_cam * stop.T_cam_target).inverse();
  out.residual = geometry::log_se3(T_seen_predicted(stop, at));
  // The residual is small (millimetres over half a metre): its own Jacobian is taken as 1.
  out.J_robot = -adjoint(T_target_flange);
  out.J << -adjoint(stop.T_cam_target.inverse()), Mat6::Identity();
  return out;
}

Mat6 covariance_of(const WeightedStop& stop, const Linearised& l, const PoseNoise& noise) {
  Twist variances;
  variances << Vec3::Constant(noise.sigma_mm * noise.sigma_mm),
      Vec3::Constant(noise.sigma_rad * noise.sigma_rad);
  return stop.covariance_seen + l.J_robot * variances.asDiagonal() * l.J_robot.transpose();
}

/// One round of estimating the variance components: sigma_i^2 <- sigma_i^2 (r' P V_i P r) / tr(P V_i), with
/// P = V^-1 - V^-1 J (J' V^-1 J)^-1 J' V^-1, which takes off the degrees of freedom that the unknowns eat.
PoseNoise improved_noise(std::span<const WeightedStop> stops, const PoseAdjustment& at) {
  const auto n = static_cast<Eigen::Index>(stops.size());
  Eigen::MatrixXd V_inverse = Eigen::MatrixXd::Zero(6 * n, 6 * n), J(6 * n, 12);
  Eigen::MatrixXd V_mm = Eigen::MatrixXd::Zero(6 * n, 6 * n), V_rad = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  Eigen::VectorXd r(6 * n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const WeightedStop& stop = stops[static_cast<std::size_t>(k)];
    const Linearised l = linearise(stop.stop, at);
    V_inverse.block<6, 6>(6 * k, 6 * k) = covariance_of(stop, l, at.noise).inverse();
    V_mm.block<6, 6>(6 * k, 6 * k) = l.J_robot.leftCols<3>() * l.J_robot.leftCols<3>().transpose();
    V_rad.block<6, 6>(6 * k, 6 * k) = l.J_robot.rightCols<3>() * l.J_robot.rightCols<3>().transpose();
    J.middleRows<6>(6 * k) = l.J;
    r.segment<6>(6 * k) = l.residual;
  }
  const Eigen::MatrixXd VJ = V_inverse * J;
  const Eigen::MatrixXd P = V_inverse - VJ * geometry::solve_symmetric(J.transpose() * VJ, VJ.transpose());
  const Eigen::VectorXd Pr = P * r;
  const auto factor = [&](const Eigen::MatrixXd& V_i) {
    const double expected = (P.cwiseProduct(V_i)).sum();  // tr(P V_i), both symmetric
    return expected > 0 ? std::clamp(Pr.dot(V_i * Pr) / expected, 0.01, 100.0) : 1.0;
  };
  return {.sigma_mm = std::max(k_least_sigma_mm, at.noise.sigma_mm * std::sqrt(factor(V_mm))),
          .sigma_rad = std::max(k_least_sigma_rad, at.noise.sigma_rad * std::sqrt(factor(V_rad)))};
}

}  // namespace

Mat6 adjoint(const SE3& T) {
  Mat6 Ad = Mat6::Zero();
  Ad.topLeftCorner<3, 3>() = T.linear();
  Ad.bottomRightCorner<3, 3>() = T.linear();
  Ad.topRightCorner<3, 3>() = geometry::hat(T.translation()) * T.linear();
  return Ad;
}

SE3 T_seen_predicted(const Stop& stop, const PoseAdjustment& adjustment) {
  return stop.T_cam_target.inverse() * (stop.T_base_flange * adjustment.T_flange_cam).inverse() *
         adjustment.T_base_target;
}

PoseAdjustment adjust_poses(std::span<const WeightedStop> stops, const PoseAdjustment& start) {
  PoseAdjustment at = start;
  at.converged = false;
  for (int iteration = 0; iteration < 30 && !at.converged; ++iteration) {
    Eigen::Matrix<double, 12, 12> information = Eigen::Matrix<double, 12, 12>::Zero();
    Eigen::Matrix<double, 12, 1> gradient = Eigen::Matrix<double, 12, 1>::Zero();
    for (const WeightedStop& stop : stops) {
      const Linearised l = linearise(stop.stop, at);
      const geometry::SymmetricSolver weight{covariance_of(stop, l, at.noise)};
      const Mat6x12 weighted = weight.solve(l.J);
      information += l.J.transpose() * weighted;
      gradient += weighted.transpose() * l.residual;
    }
    const geometry::SymmetricSolver solver{information};
    const Eigen::Matrix<double, 12, 1> step = -solver.solve(gradient);
    if (!step.allFinite()) return at;
    at.T_flange_cam = geometry::orthonormalised(at.T_flange_cam * geometry::exp_se3(step.head<6>()));
    at.T_base_target = geometry::orthonormalised(at.T_base_target * geometry::exp_se3(step.tail<6>()));
    at.covariance = solver.inverse().topLeftCorner<6, 6>();
    at.converged = step.norm() < 1e-9;
  }
  return at;
}

PoseAdjustment adjust_poses_and_noise(std::span<const WeightedStop> stops, const PoseAdjustment& start) {
  PoseAdjustment at = adjust_poses(stops, start);
  for (int round = 0; round < 40; ++round) {
    const PoseNoise noise = improved_noise(stops, at);
    const double change = std::abs(std::log(noise.sigma_mm / at.noise.sigma_mm)) +
                          std::abs(std::log(noise.sigma_rad / at.noise.sigma_rad));
    at.noise = noise;
    at = adjust_poses(stops, at);
    if (change < 1e-3) break;
  }
  return at;
}

}  // namespace biteline::calibration
