// SPDX-License-Identifier: MIT
#include "hal/sim/robot/arm_kinematics.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace biteline::sim {

namespace {

constexpr double k_right = std::numbers::pi / 2;

constexpr int k_steps = 60;
constexpr double k_met_mm = 1e-4;
constexpr double k_met_rad = 1e-7;
/// One radian weighs as much as this many millimetres, about the length of a link.
constexpr double k_lever_mm = 400;

struct ArmRow {
  const char* name;
  double d1_mm, a2_mm, a3_mm, d4_mm, d5_mm, d6_mm;
  std::array<double, 6> speed_deg_s;
  LinkShape shape;
};
/// Dimensions as published; speeds of the user manuals; shapes of their drawings, rounded up.
constexpr std::array k_arms{ArmRow{"ur3e",
                                   151.85,
                                   -243.55,
                                   -213.2,
                                   131.05,
                                   85.35,
                                   92.1,
                                   {180, 180, 180, 360, 360, 360},
                                   {120, 27, 75, 45, 40, 40}},
                            ArmRow{"ur5e",
                                   162.5,
                                   -425,
                                   -392.2,
                                   133.3,
                                   99.7,
                                   99.6,
                                   {180, 180, 180, 180, 180, 180},
                                   {138, 7, 75, 60, 50, 45}},
                            ArmRow{"ur10e",
                                   180.7,
                                   -612.7,
                                   -571.55,
                                   174.15,
                                   119.85,
                                   116.55,
                                   {120, 120, 180, 180, 180, 180},
                                   {176.2, 39.3, 95, 75, 60, 55}}};

/// The maker publishes none; controllers of the series follow this with a full payload.
constexpr double k_acceleration_rad_s2 = 5;

JointLimits limits_of(const ArmRow& arm) {
  JointLimits limits;
  limits.most_rad.setConstant(2 * std::numbers::pi);
  limits.most_rad[2] = std::numbers::pi;  // the elbow's links meet
  for (Eigen::Index i = 0; i < 6; ++i)
    limits.speed_rad_s[i] = arm.speed_deg_s[static_cast<std::size_t>(i)] * std::numbers::pi / 180;
  limits.acceleration_rad_s2.setConstant(k_acceleration_rad_s2);
  return limits;
}

}  // namespace

std::optional<ArmKinematics> ArmKinematics::named(std::string_view name) {
  for (const ArmRow& arm : k_arms) {
    if (name != arm.name) continue;
    return ArmKinematics({{{.a_mm = 0, .d_mm = arm.d1_mm, .alpha_rad = k_right},
                           {.a_mm = arm.a2_mm, .d_mm = 0, .alpha_rad = 0},
                           {.a_mm = arm.a3_mm, .d_mm = 0, .alpha_rad = 0},
                           {.a_mm = 0, .d_mm = arm.d4_mm, .alpha_rad = k_right},
                           {.a_mm = 0, .d_mm = arm.d5_mm, .alpha_rad = -k_right},
                           {.a_mm = 0, .d_mm = arm.d6_mm, .alpha_rad = 0}}},
                         limits_of(arm), arm.shape);
  }
  return std::nullopt;
}

ArmKinematics ArmKinematics::made(std::uint64_t seed) const {
  ArmKinematics own = *this;
  if (seed == 0) return own;
  // Of the rows of two published calibrations: lengths off by some tenths of a millimetre to two, angles by
  // half a milliradian to two.
  std::mt19937_64 random{seed};
  std::normal_distribution<double> length_mm{0, 0.6}, turn_rad{0, 0.0008};
  for (std::size_t i = 0; i < 6; ++i) {
    DhRow& row = own.rows_[i];
    row.theta_rad = turn_rad(random);
    row.d_mm += length_mm(random);
    if (i + 1 == 6) break;  // the flange is where the last row ends
    row.a_mm += length_mm(random);
    row.alpha_rad += turn_rad(random);
  }
  return own;
}

SE3 ArmKinematics::forward(const JointVector& q_rad, Jacobian& J) const {
  std::array<SE3, 6> frames;
  SE3 T = SE3::Identity();
  for (std::size_t i = 0; i < 6; ++i) {
    frames[i] = T;
    T.rotate(Eigen::AngleAxisd(q_rad[static_cast<Eigen::Index>(i)] + rows_[i].theta_rad, Vec3::UnitZ()));
    T.translate(Vec3(rows_[i].a_mm, 0, rows_[i].d_mm));
    T.rotate(Eigen::AngleAxisd(rows_[i].alpha_rad, Vec3::UnitX()));
  }
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3 axis = frames[i].linear().col(2);
    J.col(static_cast<Eigen::Index>(i)) << axis.cross(T.translation() - frames[i].translation()), axis;
  }
  return T;
}

SE3 ArmKinematics::T_base_flange(const JointVector& q_rad) const {
  Jacobian J;
  return forward(q_rad, J);
}

std::array<SE3, 6> ArmKinematics::T_base_joints(const JointVector& q_rad) const {
  std::array<SE3, 6> frames;
  SE3 T = SE3::Identity();
  for (std::size_t i = 0; i < 6; ++i) {
    T.rotate(Eigen::AngleAxisd(q_rad[static_cast<Eigen::Index>(i)] + rows_[i].theta_rad, Vec3::UnitZ()));
    T.translate(Vec3(0, 0, rows_[i].d_mm));
    frames[i] = T;
    T.translate(Vec3(rows_[i].a_mm, 0, 0));
    T.rotate(Eigen::AngleAxisd(rows_[i].alpha_rad, Vec3::UnitX()));
  }
  return frames;
}

std::optional<JointVector> ArmKinematics::joints_near(const SE3& T_base_flange,
                                                      const JointVector& q_near_rad) const {
  JointVector q_rad = q_near_rad;
  double damping = 1e-6;
  double last_error = 1e18;
  JointVector last_q_rad = q_rad;
  for (int step = 0; step < k_steps; ++step) {
    Jacobian J;
    const SE3 T = forward(q_rad, J);
    const Vec3 away_mm = T_base_flange.translation() - T.translation();
    const Vec3 turn_rad = geometry::log_so3(T_base_flange.linear() * T.linear().transpose());
    if (away_mm.norm() < k_met_mm && turn_rad.norm() < k_met_rad) return q_rad;
    const double error = away_mm.squaredNorm() + k_lever_mm * k_lever_mm * turn_rad.squaredNorm();
    if (error > last_error) {
      damping = std::min(damping * 10, 1.0);
      q_rad = last_q_rad;
      last_error = 1e18;
      continue;
    }
    last_error = error;
    last_q_rad = q_rad;
    damping = std::max(damping * 0.2, 1e-9);
    Eigen::Matrix<double, 6, 1> residual;
    residual << away_mm, k_lever_mm * turn_rad;
    J.bottomRows<3>() *= k_lever_mm;
    const Jacobian normal = J.transpose() * J + damping * k_lever_mm * k_lever_mm * Jacobian::Identity();
    const JointVector change_rad = normal.ldlt().solve(J.transpose() * residual);
    constexpr double k_longest_rad = 0.3;
    q_rad += change_rad * std::min(1.0, k_longest_rad / std::max(1e-12, change_rad.norm()));
  }
  return std::nullopt;
}

std::optional<JointVector> ArmKinematics::joints_anywhere(const SE3& T_base_flange) const {
  const double towards_rad =
      std::atan2(T_base_flange.translation().y(), T_base_flange.translation().x()) + std::numbers::pi;
  for (const double elbow : {1.6, -1.6}) {
    for (const double wrist : {-1.57, 1.57}) {
      for (const double q4 : {-1.6, 0.0, 1.6}) {
        JointVector start_rad;
        start_rad << towards_rad, -1.2, elbow, q4, wrist, 0;
        if (const auto found = joints_near(T_base_flange, start_rad)) return found;
      }
    }
  }
  return std::nullopt;
}

}  // namespace biteline::sim
