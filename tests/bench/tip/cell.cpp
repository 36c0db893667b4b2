// SPDX-License-Identifier: MIT
#include "tests/bench/tip/cell.hpp"

#include <numbers>
#include <random>

#include "hal/sim/shoe/random.hpp"
#include "host/calibration/handeye/hand_eye.hpp"
#include "host/robot/kinematics/dh_rows.hpp"
#include "host/robot/kinematics/tool_touch.hpp"
#include "tests/support/ring_scene.hpp"
#include "tests/support/uncertain_scan.hpp"

namespace biteline::bench {
namespace {

/// Of the way from nominal to an arm's own links that its maker's calibration leaves: flanges are then off by
/// 0.07 mm in each coordinate on average, as a laser tracker found an arm of this make to be.
constexpr double k_left_ratio = 0.07;
/// Of the true tip beside the process's, each coordinate: tools are changed, and wear.
constexpr double k_tip_sigma_mm = 0.3;
/// Of one touch, each coordinate: a careful hand repeats to 0.1 mm.
constexpr double k_touch_sigma_mm = 0.058;
constexpr int k_touches = 8, k_stops = 13, k_tries = 60;
/// Of hand-eye stops: the poses' noise and the ring centres', as calibrations of made heads have them.
constexpr double k_stop_mm = 0.020, k_stop_rad = 1e-4, k_centre_px = 0.05;

SE3 step(const sim::ArmKinematics::DhRow& row, double q_rad) {
  return Eigen::AngleAxisd(q_rad + row.theta_rad, Vec3::UnitZ()) *
         Eigen::Translation3d(row.a_mm, 0, row.d_mm) * SE3(Eigen::AngleAxisd(row.alpha_rad, Vec3::UnitX()));
}

Twist noise(sim::Random& random, double sigma_mm, double sigma_rad) {
  Twist xi;
  for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? sigma_mm : sigma_rad) * random.gaussian();
  return xi;
}

Vec3 gaussian_mm(sim::Random& random, double sigma_mm) {
  const double x = random.gaussian(), y = random.gaussian();
  return sigma_mm * Vec3(x, y, random.gaussian());
}

/// Lies on the table before the arm, its z down.
SE3 draw_target(sim::Random& random) {
  SE3 T = SE3::Identity();
  T.linear() = geometry::exp_so3(Vec3(0, 0, random.uniform({-3, 3}))) *
               geometry::exp_so3(Vec3(std::numbers::pi, 0, 0));
  T.translation() = Vec3{random.uniform({500, 700}), random.uniform({-150, 150}), random.uniform({20, 80})};
  return T;
}

struct Stops {
  std::vector<sim::JointVector> q_rad;
  SE3 T_base_target;
};

/// Where the arm holds the head before the target; Errc::OutOfReach where no target's place does.
Result<Stops> draw_stops(const TipCell& cell, const sim::ArmKinematics& arm,
                         const calibration::RingTarget& target) {
  sim::Random random = sim::Random{cell.seed}.fork(11);
  std::mt19937_64 places{cell.seed};
  for (int i = 0; i < k_tries; ++i) {
    Stops stops{.q_rad = {}, .T_base_target = draw_target(random)};
    for (const test::ViewPlace& place : test::varied_places(k_stops, places)) {
      const SE3 T_flange_target = cell.head.T_flange_cam * test::T_cam_target_of(target, place);
      const auto q_rad = arm.joints_anywhere(stops.T_base_target * T_flange_target.inverse(Eigen::Isometry));
      if (!q_rad) break;
      stops.q_rad.push_back(*q_rad);
    }
    if (stops.q_rad.size() == k_stops) return stops;
  }
  return fail(Errc::OutOfReach, "no place for the hand-eye's target");
}

/// A head's mounting as its calibration finds it.
Result<calibration::HandEyeCalibration> find_mounting(const TipCell& cell, const Variant& variant,
                                                      const geometry::Camera& camera) {
  const test::RingScene scene{.camera = cell.head.camera};
  const sim::ArmKinematics& arm = cell.arm.controller(variant.reckoning);
  BITELINE_ASSIGN(const Stops stops, draw_stops(cell, arm, scene.target));
  sim::Random random = sim::Random{cell.seed}.fork(12);
  std::mt19937_64 centres{cell.seed + 1};
  std::vector<calibration::HandEyeView> views;
  for (const sim::JointVector& q_rad : stops.q_rad) {
    const bool exact = !variant.sources.links;
    const SE3 T_base_flange = cell.arm.T_base_flange(q_rad, exact);
    const SE3 T_cam_target =
        (T_base_flange * cell.head.T_flange_cam).inverse(Eigen::Isometry) * stops.T_base_target;
    const auto pose = calibration::fit_plane_pose(
        camera, test::exact_view(scene, T_cam_target, "", k_centre_px, centres).centres);
    if (!pose) return fail(Errc::Degenerate, "the target's pose");
    const SE3 told = (exact ? T_base_flange : arm.T_base_flange(q_rad)) *
                     geometry::exp_se3(noise(random, k_stop_mm, k_stop_rad));
    views.push_back({.name = "", .T_base_flange = told, .pose = *pose, .readings = {calibration::Reading{}}});
  }
  return calibration::calibrate_hand_eye(
      views, {.centre_sigma_px = k_centre_px, .middle_target = scene.target.middle_target()});
}

/// The `i`-th side from which the tip touches: downwards, leaning by 35 degrees all round.
Mat3 side(int i) {
  constexpr double k_lean_rad = 0.6;
  const double to_rad = 2 * std::numbers::pi * i / k_touches;
  return geometry::exp_so3(Vec3(std::numbers::pi, 0, 0)) *
         geometry::exp_so3(k_lean_rad * Vec3(std::cos(to_rad), std::sin(to_rad), 0));
}

}  // namespace

OwnArm::OwnArm(std::uint64_t seed)
    : nominal_{*sim::ArmKinematics::named(k_tip_arm)}, own_{nominal_.made(seed)}, rows_{own_.rows()} {
  constexpr std::uint64_t k_left_seed = 0x4C454654;
  const auto &nominal = nominal_.rows(), other = nominal_.made(seed ^ k_left_seed).rows();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    rows_[i].a_mm += k_left_ratio * (other[i].a_mm - nominal[i].a_mm);
    rows_[i].d_mm += k_left_ratio * (other[i].d_mm - nominal[i].d_mm);
    rows_[i].alpha_rad += k_left_ratio * (other[i].alpha_rad - nominal[i].alpha_rad);
    rows_[i].theta_rad += k_left_ratio * (other[i].theta_rad - nominal[i].theta_rad);
  }
}

Result<kinematics::ArmModel> OwnArm::planned(Reckoning reckoning) const {
  BITELINE_ASSIGN(const kinematics::ArmModel nominal, kinematics::arm_model(k_tip_arm));
  if (reckoning != Reckoning::Own) return nominal;
  std::array<kinematics::DhRow, kinematics::k_joints> rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const sim::ArmKinematics::DhRow& row = own_.rows()[i];
    rows[i] = {.theta_rad = row.theta_rad, .a_mm = row.a_mm, .d_mm = row.d_mm, .alpha_rad = row.alpha_rad};
  }
  return kinematics::with_rows(nominal, rows, "the controller");
}

SE3 OwnArm::T_base_flange(const sim::JointVector& q_rad, bool exact) const {
  if (exact) return own_.T_base_flange(q_rad);
  SE3 T = SE3::Identity();
  for (std::size_t i = 0; i < rows_.size(); ++i) T = T * step(rows_[i], q_rad[static_cast<Eigen::Index>(i)]);
  return T;
}

TipCell draw_cell(std::uint64_t seed, const sim::MadeHead& head) {
  sim::Random random = sim::Random{seed}.fork(10);
  TipCell cell{.arm = OwnArm{seed},
               .head = head.model,
               .known = test::drawn_uncertainty(head.model, head.working_distance_mm, random),
               .error = {},
               .tip_off_mm = {},
               .seed = seed};
  cell.error = test::drawn_error(cell.known.covariance, random);
  cell.tip_off_mm = gaussian_mm(random, k_tip_sigma_mm);
  return cell;
}

Result<uncertainty::KnownHead> calibrated_head(const TipCell& cell, const Variant& variant) {
  uncertainty::Parameters error = uncertainty::Parameters::Zero();
  if (variant.sources.head)
    error.head<uncertainty::k_mounting_at>() = cell.error.head<uncertainty::k_mounting_at>();
  uncertainty::KnownHead known{.model = uncertainty::perturbed(cell.head, cell.known, error),
                               .uncertainty = cell.known};
  if (!variant.sources.hand_eye) return known;
  BITELINE_ASSIGN(const calibration::HandEyeCalibration mounting,
                  find_mounting(cell, variant, known.model.camera));
  known.model.T_flange_cam = mounting.T_flange_cam;
  uncertainty::Covariance& covariance = known.uncertainty.covariance;
  covariance.middleRows<6>(uncertainty::k_mounting_at).setZero();
  covariance.middleCols<6>(uncertainty::k_mounting_at).setZero();
  covariance.block<6, 6>(uncertainty::k_mounting_at, uncertainty::k_mounting_at) = mounting.covariance;
  known.uncertainty.pose_sigma_mm = mounting.pose_sigma_mm;
  known.uncertainty.pose_sigma_rad = mounting.pose_sigma_rad;
  return known;
}

Result<TaughtTip> teach_tip(const TipCell& cell, const Variant& variant, const path::Tool& tool) {
  TaughtTip tip{.taught_flange = {}, .true_flange = tool.T_flange_tcp.translation() + cell.tip_off_mm};
  tip.taught_flange = tip.true_flange;
  if (!variant.sources.tip) return tip;
  const sim::ArmKinematics& arm = cell.arm.controller(variant.reckoning);
  const bool exact = !variant.sources.links;
  const Vec3 point_base{600, 0, 150};
  sim::Random random = sim::Random{cell.seed}.fork(13);
  std::vector<SE3> told;
  for (int i = 0; i < k_touches; ++i) {
    const Vec3 touched_base = point_base + gaussian_mm(random, k_touch_sigma_mm);
    SE3 T_base_flange = SE3::Identity();
    T_base_flange.linear() = side(i);
    T_base_flange.translation() = touched_base - T_base_flange.linear() * tip.true_flange;
    std::optional<sim::JointVector> q_rad = arm.joints_anywhere(T_base_flange);
    // The hand looks at the tip: it moves on until that touches, whatever the controller reckons.
    for (int look = 0; look < 4 && q_rad; ++look) {
      T_base_flange.translation() += touched_base - cell.arm.T_base_flange(*q_rad, exact) * tip.true_flange;
      q_rad = arm.joints_near(T_base_flange, *q_rad);
    }
    if (!q_rad) return fail(Errc::OutOfReach, "touch %d", i);
    told.push_back(exact ? cell.arm.T_base_flange(*q_rad, exact) : arm.T_base_flange(*q_rad));
  }
  // An arm that nobody measured meets no point; its touches are taken all the same, to show what comes of it.
  kinematics::ToolTouchLimits limits;
  if (variant.reckoning == Reckoning::Nominal) limits = {.max_rms_mm = 10, .max_sigma_mm = 10};
  BITELINE_ASSIGN(const kinematics::ToolTouch touch, kinematics::fit_tool_touch(told, limits));
  tip.taught_flange = touch.tip_flange;
  tip.u95_mm = touch.u95_mm;
  return tip;
}

sim::ArmDynamics dynamics_of(const Sources& sources) {
  sim::ArmDynamics dynamics = sim::common_arm_dynamics();
  if (!sources.give) dynamics.elastic_hz = 0;
  if (!sources.following) {
    dynamics.following_s = 0;
    dynamics.latency = Nanoseconds{0};
  }
  return dynamics;
}

}  // namespace biteline::bench
