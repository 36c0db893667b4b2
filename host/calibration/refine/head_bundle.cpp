// SPDX-License-Identifier: MIT
#include "host/calibration/refine/head_bundle.hpp"

#include <cmath>

#include "host/calibration/refine/head_residuals.hpp"

namespace biteline::calibration {

namespace {

/// The problem with its parameter blocks.
class HeadProblem {
 public:
  HeadProblem(const HeadObservations& seen, const HeadState& start, double stripe_factor)
      : seen_{seen}, start_{start} {
    camera_ = to_parameters(start.camera);
    problem_.AddParameterBlock(camera_.data(), k_camera_parameters);
    std::vector<int> held;
    for (int i = 0; i < 5; ++i) {
      if (!start.distortion[static_cast<std::size_t>(i)]) held.push_back(k_k1 + i);
    }
    if (!held.empty())
      problem_.SetManifold(camera_.data(), new ceres::SubsetManifold(k_camera_parameters, held));
    add_free();
    add_stripe(stripe_factor);
    add_arm();
    if (seen.camera_known) problem_.SetParameterBlockConstant(camera_.data());
  }

  ceres::Solver::Summary solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = 60;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-11;
    options.gradient_tolerance = 1e-12;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    return summary;
  }

  [[nodiscard]] HeadFit result() {
    HeadFit fit;
    fit.state = start_;
    fit.state.camera = to_camera(camera_);
    fit.plane_axes = plane_.axes;
    fit.plane_middle_cam = plane_.middle;
    if (!seen_.stripe.empty()) {
      const Vec3 normal = (plane_.normal + plane_.axes * delta_.head<2>()).normalized();
      fit.state.plane = {.normal_cam = normal, .distance_mm = normal.dot(plane_.middle) + delta_[2]};
      fit.state.T_plane1_plane2 = start_.T_plane1_plane2 * perturbation(xi_12_.data());
    }
    for (std::size_t v = 0; v < seen_.stripe.size(); ++v) fit.T_cam_plane.push_back(planes_of(v, fit.state));
    if (!seen_.arm.empty()) {
      fit.state.T_flange_cam = start_.T_flange_cam * perturbation(xi_mount_.data());
      fit.state.T_base_target = start_.T_base_target * perturbation(xi_target_.data());
    }
    measure(fit);
    return fit;
  }

  bool covariance(HeadMatrix& out) {
    std::vector<const double*> blocks;
    std::vector<int> sizes, places;
    if (!seen_.camera_known) {
      blocks.push_back(camera_.data());
      sizes.push_back(9);
      places.push_back(0);
    }
    if (!seen_.stripe.empty()) {
      blocks.push_back(delta_.data());
      sizes.push_back(3);
      places.push_back(9);
    }
    if (!seen_.arm.empty()) {
      blocks.push_back(xi_mount_.data());
      sizes.push_back(6);
      places.push_back(12);
    }
    ceres::Covariance::Options options;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    ceres::Covariance covariance(options);
    std::vector<std::pair<const double*, const double*>> pairs;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (std::size_t j = i; j < blocks.size(); ++j) pairs.emplace_back(blocks[i], blocks[j]);
    }
    if (!covariance.Compute(pairs, &problem_)) return false;
    out.setZero();
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (std::size_t j = i; j < blocks.size(); ++j) {
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> block(sizes[i], sizes[j]);
        if (!covariance.GetCovarianceBlock(blocks[i], blocks[j], block.data())) return false;
        out.block(places[i], places[j], sizes[i], sizes[j]) = block;
        out.block(places[j], places[i], sizes[j], sizes[i]) = block.transpose();
      }
    }
    return true;
  }

  [[nodiscard]] int stripe_count() const { return static_cast<int>(stripe_residuals_.size()); }
  /// RMS of the stripe's residuals, in stated standard deviations.
  [[nodiscard]] double stripe_level() const { return rms(stripe_residuals_, 1); }

 private:
  [[nodiscard]] std::vector<SE3> planes_of(std::size_t v, const HeadState& state) const {
    const StripeView& view = seen_.stripe[v];
    std::vector<SE3> T_cam_plane;
    for (std::size_t k = 0; k < view.planes.size(); ++k) {
      const bool second_rigid = k == 1 && view.rigid;
      T_cam_plane.push_back(second_rigid
                                ? SE3(T_cam_plane[0] * state.T_plane1_plane2)
                                : SE3(view.T_cam_plane[k] * perturbation(xi_stripe_[2 * v + k].data())));
    }
    return T_cam_plane;
  }

  void add_free() {
    xi_free_.assign(seen_.free.size(), Twist::Zero());
    for (std::size_t v = 0; v < seen_.free.size(); ++v) {
      for (const CentreObservation& c : seen_.free[v].view.centres)
        add_ring(c, seen_.free[v].T_cam_target, xi_free_[v]);
    }
  }

  void add_ring(const CentreObservation& c, const SE3& T_cam_target, Twist& xi) {
    ring_residuals_.push_back(problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<FreeRing, 2, k_camera_parameters, 6>(
            new FreeRing{.seen = c, .T_cam_target = T_cam_target, .sigma_px = seen_.centre_sigma_px}),
        nullptr, camera_.data(), xi.data()));
  }

  void add_stripe(double factor) {
    if (seen_.stripe.empty()) return;
    set_up_plane();
    // One block per view, and a second one where the planes are not related; a constant one stands in for the
    // identity.
    xi_stripe_.assign(2 * seen_.stripe.size(), Twist::Zero());
    problem_.AddParameterBlock(delta_.data(), 3);
    problem_.AddParameterBlock(fixed_.data(), 6);
    problem_.SetParameterBlockConstant(fixed_.data());
    for (std::size_t v = 0; v < seen_.stripe.size(); ++v) {
      const StripeView& view = seen_.stripe[v];
      for (std::size_t k = 0; k < view.planes.size(); ++k) {
        for (const CentreObservation& c : view.planes[k].centres) {
          if (k == 1 && view.rigid) {
            ring_residuals_.push_back(problem_.AddResidualBlock(
                new ceres::AutoDiffCostFunction<SecondPlaneRing, 2, k_camera_parameters, 6, 6>(
                    new SecondPlaneRing{.seen = c,
                                        .T_cam_plane1 = view.T_cam_plane[0],
                                        .T_plane1_plane2 = start_.T_plane1_plane2,
                                        .sigma_px = seen_.centre_sigma_px}),
                nullptr, camera_.data(), xi_stripe_[2 * v].data(), xi_12_.data()));
          } else {
            add_ring(c, view.T_cam_plane[k], xi_stripe_[2 * v + k]);
          }
        }
      }
      for (const PlaneStripePoint& p : view.points) add_stripe_point(v, p, factor);
    }
  }

  void add_stripe_point(std::size_t v, const PlaneStripePoint& p, double factor) {
    const StripeView& view = seen_.stripe[v];
    const bool second_rigid = p.plane == 1 && view.rigid;
    const auto k = static_cast<std::size_t>(p.plane);
    Stripe cost{.seen = p.seen,
                .T_cam_plane1 = second_rigid ? view.T_cam_plane[0] : view.T_cam_plane[k],
                .T_plane1_plane2 = second_rigid ? start_.T_plane1_plane2 : SE3::Identity(),
                .plane = plane_,
                .mm_per_px = 1,
                .factor = factor};
    cost.mm_per_px = mm_per_px(cost);
    Twist& xi = second_rigid ? xi_stripe_[2 * v] : xi_stripe_[2 * v + k];
    stripe_mm_.push_back(cost.mm_per_px * p.seen.sigma_px * factor);
    stripe_residuals_.push_back(problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Stripe, 1, k_camera_parameters, 3, 6, 6>(new Stripe(cost)), nullptr,
        camera_.data(), delta_.data(), xi.data(), second_rigid ? xi_12_.data() : fixed_.data()));
  }

  /// How far the point moves off the laser plane when the stripe moves by one row.
  [[nodiscard]] double mm_per_px(const Stripe& cost) const {
    const double zero[6] = {0, 0, 0, 0, 0, 0};
    double at = 0, beside = 0;
    Stripe unit = cost;
    unit.seen.sigma_px = unit.factor = 1;
    Stripe moved_cost = unit;
    moved_cost.seen.pixel_px.y() += 0.5;
    unit.seen.pixel_px.y() -= 0.5;
    unit(camera_.data(), zero, zero, zero, &at);
    moved_cost(camera_.data(), zero, zero, zero, &beside);
    return std::max(1e-4, std::abs(beside - at));
  }

  void set_up_plane() {
    plane_.normal = start_.plane.normal_cam;
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for (const StripeView& view : seen_.stripe) {
      for (const PlaneStripePoint& p : view.points) {
        sum += geometry::triangulate(start_.camera, start_.plane, p.seen.pixel_px);
        count += 1;
      }
    }
    plane_.middle = count > 0 ? Vec3(sum / count) : Vec3(start_.plane.normal_cam * start_.plane.distance_mm);
    plane_.middle -= start_.plane.signed_distance_mm(plane_.middle) * start_.plane.normal_cam;
    const Vec3 across = std::abs(plane_.normal.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
    plane_.axes.col(0) = (across - across.dot(plane_.normal) * plane_.normal).normalized();
    plane_.axes.col(1) = plane_.normal.cross(Vec3(plane_.axes.col(0)));
  }

  void add_arm() {
    if (seen_.arm.empty()) return;
    xi_flange_.assign(seen_.arm.size(), Twist::Zero());
    for (std::size_t v = 0; v < seen_.arm.size(); ++v) {
      for (const CentreObservation& c : seen_.arm[v].view.centres) {
        arm_residuals_.push_back(problem_.AddResidualBlock(
            new ceres::AutoDiffCostFunction<ArmRing, 2, k_camera_parameters, 6, 6, 6>(
                new ArmRing{.seen = c,
                            .T_base_flange = seen_.arm[v].T_base_flange,
                            .T_flange_cam = start_.T_flange_cam,
                            .T_base_target = start_.T_base_target,
                            .sigma_px = seen_.centre_sigma_px}),
            nullptr, camera_.data(), xi_flange_[v].data(), xi_mount_.data(), xi_target_.data()));
      }
      problem_.AddResidualBlock(
          new ceres::AutoDiffCostFunction<RobotPrior, 6, 6>(new RobotPrior{.noise = seen_.pose_noise}),
          nullptr, xi_flange_[v].data());
    }
  }

  /// RMS over the blocks, a block of `dimension` counting once.
  [[nodiscard]] double rms(const std::vector<ceres::ResidualBlockId>& blocks, int dimension) const {
    double sum = 0;
    for (const ceres::ResidualBlockId id : blocks) {
      double cost = 0, residual[6];
      if (problem_.EvaluateResidualBlock(id, false, &cost, residual, nullptr)) {
        for (int i = 0; i < dimension; ++i) sum += residual[i] * residual[i];
      }
    }
    return blocks.empty() ? 0 : std::sqrt(sum / static_cast<double>(blocks.size()));
  }

  void measure(HeadFit& fit) const {
    std::vector<ceres::ResidualBlockId> rings = ring_residuals_;
    rings.insert(rings.end(), arm_residuals_.begin(), arm_residuals_.end());
    fit.rms_px = rms(rings, 2) * seen_.centre_sigma_px;
    fit.arm_rms_px = rms(arm_residuals_, 2) * seen_.centre_sigma_px;
    double sum_mm2 = 0;
    for (std::size_t i = 0; i < stripe_residuals_.size(); ++i) {
      double cost = 0, residual = 0;
      if (problem_.EvaluateResidualBlock(stripe_residuals_[i], false, &cost, &residual, nullptr))
        sum_mm2 += std::pow(residual * stripe_mm_[i], 2);
    }
    fit.stripe_rms_mm =
        stripe_residuals_.empty() ? 0 : std::sqrt(sum_mm2 / static_cast<double>(stripe_residuals_.size()));
    double sum_pose_mm2 = 0, sum_pose_rad2 = 0;
    for (const Twist& xi : xi_flange_) {
      sum_pose_mm2 += xi.head<3>().squaredNorm();
      sum_pose_rad2 += xi.tail<3>().squaredNorm();
    }
    if (!xi_flange_.empty()) {
      fit.pose_rms_mm = std::sqrt(sum_pose_mm2 / static_cast<double>(xi_flange_.size()));
      fit.pose_rms_rad = std::sqrt(sum_pose_rad2 / static_cast<double>(xi_flange_.size()));
    }
  }

  const HeadObservations& seen_;
  const HeadState& start_;
  PlaneModel plane_{
      .normal = Vec3::UnitZ(), .middle = Vec3::Zero(), .axes = Eigen::Matrix<double, 3, 2>::Zero()};
  CameraVector camera_{CameraVector::Zero()};
  Vec3 delta_{Vec3::Zero()};
  Twist xi_12_{Twist::Zero()}, xi_mount_{Twist::Zero()}, xi_target_{Twist::Zero()}, fixed_{Twist::Zero()};
  std::vector<Twist> xi_free_, xi_stripe_, xi_flange_;
  std::vector<ceres::ResidualBlockId> ring_residuals_, arm_residuals_, stripe_residuals_;
  std::vector<double> stripe_mm_;
  ceres::Problem problem_;  // after the blocks it points to
};

}  // namespace

Vec3 HeadFit::triangulation_sigma_mm(const Vec2& pixel_px) const {
  const auto point = [&](int parameter, double step) -> Vec3 {
    CameraVector camera = to_parameters(state.camera);
    Vec3 delta = Vec3::Zero();
    if (parameter < 9) camera[parameter] += step;
    if (parameter >= 9) delta[parameter - 9] += step;
    const Vec3 normal = (state.plane.normal_cam + plane_axes * delta.head<2>()).normalized();
    const Vec3 middle =
        plane_middle_cam - state.plane.signed_distance_mm(plane_middle_cam) * state.plane.normal_cam;
    return geometry::triangulate(
        to_camera(camera), {.normal_cam = normal, .distance_mm = normal.dot(middle) + delta[2]}, pixel_px);
  };
  Eigen::Matrix<double, 3, 12> J;
  for (int i = 0; i < 12; ++i) {
    const double step = i < 4 ? 1e-2 : 1e-5;  // px; coefficients, rad and mm
    J.col(i) = (point(i, step) - point(i, -step)) / (2 * step);
  }
  return (J * covariance.topLeftCorner<12, 12>() * J.transpose()).diagonal().cwiseMax(0).cwiseSqrt();
}

HeadFit solve_head(const HeadObservations& observations, const HeadState& start) {
  // The second round knows how noisy the stripe really is.
  double factor = 1;
  for (int round = 0;; ++round) {
    HeadProblem problem(observations, start, factor);
    const ceres::Solver::Summary summary = problem.solve();
    const double level = problem.stripe_level();
    if (round == 0 && problem.stripe_count() > 10 && level > 0) {
      factor = std::max(0.3, level);
      continue;
    }
    HeadFit fit = problem.result();
    fit.stripe_sigma_factor = factor;
    fit.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps;
    fit.converged = summary.termination_type == ceres::CONVERGENCE && problem.covariance(fit.covariance);
    return fit;
  }
}

}  // namespace biteline::calibration
