// SPDX-License-Identifier: MIT
#include "host/calibration/camera/bundle.hpp"

#include <ceres/ceres.h>

#include <cmath>

#include "host/calibration/camera/reprojection.hpp"

namespace biteline::calibration {

namespace {

static_assert(k_camera_count == k_camera_parameters);

struct Reprojection {
  CentreObservation seen;
  SE3 T_cam_target;

  template <class T>
  bool operator()(const T* camera, const T* xi, T* residual) const {
    const Eigen::Matrix<T, 3, 1> point_cam =
        moved(T_cam_target, xi, Eigen::Matrix<T, 3, 1>(seen.point_target.cast<T>()));
    if (!(point_cam[2] > T(0))) return false;
    const Eigen::Matrix<T, 2, 1> pixel = project(camera, point_cam);
    residual[0] = pixel[0] - seen.pixel_px.x();
    residual[1] = pixel[1] - seen.pixel_px.y();
    return true;
  }
};

}  // namespace

double BundleFit::sigma_px() const {
  return residuals > unknowns ? std::sqrt(sum_px2 / (residuals - unknowns)) : 0.0;
}

double BundleFit::rms_px() const {
  return residuals > 0 ? std::sqrt(2 * sum_px2 / residuals) : 0.0;
}

BundleFit solve_bundle(std::span<const PlaneView* const> views, const BundleStart& start) {
  CameraVector camera = to_parameters(start.camera);
  std::vector<int> held;
  for (int i = 0; i < 5; ++i) {
    if (start.distortion[static_cast<std::size_t>(i)]) continue;
    held.push_back(k_k1 + i);
    camera[k_k1 + i] = 0;
  }
  std::vector<Twist> xi(views.size(), Twist::Zero());
  ceres::Problem problem;
  problem.AddParameterBlock(camera.data(), k_camera_count);
  if (!held.empty()) problem.SetManifold(camera.data(), new ceres::SubsetManifold(k_camera_count, held));
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (const CentreObservation& centre : views[v]->centres) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Reprojection, 2, k_camera_count, 6>(
                                   new Reprojection{.seen = centre, .T_cam_target = start.T_cam_target[v]}),
                               nullptr, camera.data(), xi[v].data());
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.jacobi_scaling = true;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  BundleFit fit;
  fit.camera = to_camera(camera);
  for (std::size_t v = 0; v < views.size(); ++v)
    fit.T_cam_target.push_back(start.T_cam_target[v] * perturbation(xi[v].data()));
  fit.sum_px2 = 2 * summary.final_cost;
  fit.residuals = summary.num_residuals;
  fit.unknowns = summary.num_effective_parameters;
  fit.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps;
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  if (start.with_covariance) {
    ceres::Covariance::Options covariance_options;
    covariance_options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    ceres::Covariance covariance(covariance_options);
    Eigen::Matrix<double, k_camera_count, k_camera_count, Eigen::RowMajor> block;
    const std::vector<std::pair<const double*, const double*>> wanted{{camera.data(), camera.data()}};
    if (covariance.Compute(wanted, &problem) &&
        covariance.GetCovarianceBlock(camera.data(), camera.data(), block.data())) {
      fit.covariance_per_px2 = block;
    } else {
      fit.converged = false;
    }
  }
  return fit;
}

}  // namespace biteline::calibration
