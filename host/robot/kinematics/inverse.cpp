// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/inverse.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <optional>

#include "host/robot/kinematics/chain.hpp"

namespace biteline::kinematics {
namespace {

constexpr double k_pi = std::numbers::pi;

// An arm stretched to its end makes a cosine of 1 plus rounding; 1e-9 of a metre is a nanometre.
constexpr double k_rounding = 1e-9;
// How far beyond the nominal reach a calibrated arm may still go: its links differ by up to a few
// millimetres.
constexpr double k_calibrated_slack = 0.1;
// Below this |sin q5| the wrist counts as singular for the nominal closed form: q6 would lose more than 7
// digits.
constexpr double k_wrist_singular = 1e-8;

double wrapped(double angle_rad) {
  const double turned = std::remainder(angle_rad, 2 * k_pi);
  return turned <= -k_pi ? turned + 2 * k_pi : turned;
}

/// acos, or nothing when the argument is out of range by more than `slack`.
std::optional<double> acos_within(double cosine, double slack) {
  if (std::abs(cosine) <= 1) return std::acos(cosine);
  if (std::abs(cosine) <= 1 + slack) return cosine > 0 ? 0.0 : k_pi;
  return std::nullopt;
}

struct ClosedFormOptions {
  double slack;  ///< how far beyond the reach a branch is still followed (to its edge)
  double q6_hint_rad;
};

/// Elbow, shoulder lift and wrist 1 for given q1, q5, q6: a planar arm of two links.
void solve_plane(const DhLengths& arm, const std::array<SE3, k_joints>& fixed, const SE3& T_base_flange,
                 const Joints& partial, Branch branch, const ClosedFormOptions& options,
                 Solutions& solutions) {
  const auto joint = [&](std::size_t i) {
    SE3 T = fixed[i];
    T.rotate(Eigen::AngleAxisd(partial[static_cast<Eigen::Index>(i)], Vec3::UnitZ()));
    return T;
  };
  // T_2_w: what the joints 2 to 4 together have to do, in the frame of joint 2's fixed part.
  const SE3 T_2_w = (joint(0) * fixed[1]).inverse() * T_base_flange * (joint(4) * joint(5)).inverse();
  const double x_mm = T_2_w.translation().x(), y_mm = T_2_w.translation().y();
  const double sum_rad = std::atan2(T_2_w.linear()(1, 0), T_2_w.linear()(0, 0));  // q2 + q3 + q4
  const double cosine = (x_mm * x_mm + y_mm * y_mm - arm.a2_mm * arm.a2_mm - arm.a3_mm * arm.a3_mm) /
                        (2 * arm.a2_mm * arm.a3_mm);
  const std::optional<double> elbow_rad = acos_within(cosine, options.slack);
  if (!elbow_rad) return;
  for (const double q3_rad : {*elbow_rad, -*elbow_rad}) {
    Joints q_rad = partial;
    q_rad[2] = q3_rad;
    q_rad[1] = std::atan2(y_mm, x_mm) -
               std::atan2(arm.a3_mm * std::sin(q3_rad), arm.a2_mm + arm.a3_mm * std::cos(q3_rad));
    q_rad[3] = sum_rad - q_rad[1] - q_rad[2];
    for (double& angle_rad : q_rad) angle_rad = wrapped(angle_rad);
    solutions.add({.q_rad = q_rad, .branch = static_cast<Branch>(branch | (q3_rad < 0 ? 4U : 0U))});
  }
}

/// Hawkins 2013, "Analytic Inverse Kinematics for the Universal Robots UR-5/UR-10 Arms", with these frames.
Solutions inverse_nominal(const DhLengths& arm, const SE3& T_base_flange, const ClosedFormOptions& options) {
  Solutions solutions;
  const Mat3 R = T_base_flange.linear();
  const Vec3 flange = T_base_flange.translation();
  const Vec3 wrist = flange - arm.d6_mm * R.col(2);
  const double radius_mm = std::hypot(wrist.x(), wrist.y());
  if (radius_mm < 1e-9) return solutions;  // on the base axis: inside the inner cylinder anyway
  const std::optional<double> side_rad = acos_within(arm.d4_mm / radius_mm, options.slack);
  if (!side_rad) return solutions;

  const std::array<SE3, k_joints> fixed = nominal_frames(arm);
  for (const Branch shoulder : {Branch{0}, Branch{1}}) {
    Joints q_rad = Joints::Zero();
    const double sign = shoulder == 0 ? 1 : -1;
    q_rad[0] = std::atan2(wrist.y(), wrist.x()) + sign * *side_rad + k_pi / 2;
    const double s1 = std::sin(q_rad[0]), c1 = std::cos(q_rad[0]);
    const std::optional<double> q5_rad =
        acos_within((flange.x() * s1 - flange.y() * c1 - arm.d4_mm) / arm.d6_mm, options.slack);
    if (!q5_rad) continue;
    for (const Branch wrist_side : {Branch{0}, Branch{1}}) {
      q_rad[4] = wrist_side == 0 ? *q5_rad : -*q5_rad;
      const double s5 = std::sin(q_rad[4]);
      if (std::abs(s5) < k_wrist_singular) {
        q_rad[5] = options.q6_hint_rad;
      } else {
        q_rad[5] = std::atan2((-R(0, 1) * s1 + R(1, 1) * c1) / s5, (R(0, 0) * s1 - R(1, 0) * c1) / s5);
      }
      solve_plane(arm, fixed, T_base_flange, q_rad, static_cast<Branch>(shoulder | (wrist_side << 1U)),
                  options, solutions);
    }
  }
  return solutions;
}

// One millimetre counts as much as one milliradian: an arm's length in metres, rounded to 1.
constexpr double k_length_mm = 1000;

/// What is left between the pose of `q_rad` and the target: [mm / k_length_mm; rad], in base.
Twist residual(const ArmModel& arm, const Joints& q_rad, const SE3& T_base_flange) {
  const SE3 T_now = forward(arm, q_rad);
  Twist left;
  left.head<3>() = (T_base_flange.translation() - T_now.translation()) / k_length_mm;
  left.tail<3>() = geometry::log_so3(T_base_flange.linear() * T_now.linear().transpose());
  return left;
}

/// Where the steps below ended, and whether the pose is met there.
struct Refined {
  Joints q_rad;
  bool met{false};
};

/// Levenberg-Marquardt from the nominal solution.
Refined refined(const ArmModel& arm, Joints q_rad, const SE3& T_base_flange) {
  constexpr int k_max_steps = 40;
  constexpr double k_met = 1e-12;  // 1e-9 mm, 1e-12 rad
  Twist left = residual(arm, q_rad, T_base_flange);
  double damping = 1e-8;
  for (int step = 0; step < k_max_steps && left.norm() > k_met; ++step) {
    Jacobian J = jacobian(arm, q_rad, forward(arm, q_rad).translation());
    J.topRows<3>() /= k_length_mm;
    Eigen::Matrix<double, 6, 6> A = J.transpose() * J;
    A.diagonal().array() += damping;
    const Joints trial_rad = q_rad + A.ldlt().solve(J.transpose() * left);
    const Twist left_then = residual(arm, trial_rad, T_base_flange);
    if (left_then.norm() < left.norm()) {
      q_rad = trial_rad;
      left = left_then;
      damping = std::max(damping * 0.1, 1e-16);
    } else {
      damping *= 10;
      if (damping > 0.01) break;  // a step this short gains nothing: the branch ends before the pose
    }
  }
  constexpr double k_accepted = 1e-10;  // 1e-7 mm, 1e-10 rad: what a doubled root near a singularity leaves
  for (double& angle_rad : q_rad) angle_rad = wrapped(angle_rad);
  return {.q_rad = q_rad, .met = left.norm() <= k_accepted};
}

/// The joints on both sides of a fold near `q_rad`.  Along the direction in which the arm hardly moves the
/// flange (the least singular value's) what is left of the pose is a parabola; its two roots are where the
/// branches that meet in the fold cross the pose.  No step of first order leads there from the fold itself,
/// nor from one branch to the other.
Solutions across_fold(const ArmModel& arm, const Joints& q_rad, const SE3& T_base_flange, int which) {
  constexpr double k_step_rad = 1e-3;     // second differences: 1e-16 / 1e-6 of rounding
  constexpr double k_farthest_rad = 0.7;  // beyond it the parabola is none
  Jacobian J = jacobian(arm, q_rad, forward(arm, q_rad).translation());
  J.topRows<3>() /= k_length_mm;
  const Eigen::JacobiSVD<Jacobian> svd{J, Eigen::ComputeFullU | Eigen::ComputeFullV};
  const Twist u = svd.matrixU().col(which);
  const Joints v = svd.matrixV().col(which);
  const auto along = [&](double step_rad) {
    return u.dot(residual(arm, q_rad + step_rad * v, T_base_flange));
  };
  const double c = along(0), plus = along(k_step_rad), minus = along(-k_step_rad);
  const double a = (plus + minus - 2 * c) / (2 * k_step_rad * k_step_rad),
               b = (plus - minus) / (2 * k_step_rad);
  Solutions starts;
  if (std::abs(a) < 1e-6) return starts;
  const double root = std::sqrt(std::max(0.0, b * b - 4 * a * c));
  for (const double t : {(-b + root) / (2 * a), (-b - root) / (2 * a)}) {
    if (std::abs(t) < k_farthest_rad) starts.add({.q_rad = q_rad + t * v});
  }
  return starts;
}

bool is_among(const Solutions& solutions, const Joints& q_rad) {
  for (const Solution& solution : solutions) {
    double worst_rad = 0;
    for (int i = 0; i < 6; ++i)
      worst_rad = std::max(worst_rad, std::abs(wrapped(solution.q_rad[i] - q_rad[i])));
    if (worst_rad < 1e-6) return true;
  }
  return false;
}

/// Whether two branches of the nominal arm meet near this pose, or one ends: a cosine of its closed form is
/// within k_fold_margin of 1 or -1 for some branch.
bool near_a_fold(const DhLengths& arm, const SE3& T_base_flange) {
  constexpr double k_fold_margin = 0.06;
  bool near = false;
  const auto look = [&](double cosine) { near = near || std::abs(std::abs(cosine) - 1) < k_fold_margin; };
  const Vec3 wrist = T_base_flange.translation() - arm.d6_mm * T_base_flange.linear().col(2);
  look(arm.d4_mm / std::max(1e-9, std::hypot(wrist.x(), wrist.y())));
  for (const Solution& solution : inverse_nominal(arm, T_base_flange, {.slack = 1, .q6_hint_rad = 0})) {
    look(std::cos(solution.q_rad[2]));
    look(std::cos(solution.q_rad[4]));
  }
  return near;
}

/// Poses around the target: where a branch begins or two meet, the nominal arm has the calibrated arm's
/// branches only some millimetres or a degree away, in a direction that nobody knows.  Halton points over the
/// twists, near ones denser.
std::array<SE3, 32> around(const SE3& T_base_flange) {
  constexpr std::array<unsigned, 7> k_bases{2, 3, 5, 7, 11, 13, 17};
  const auto halton = [](unsigned index, unsigned base) {
    double fraction = 1, value = 0;
    for (; index > 0; index /= base) {
      fraction /= base;
      value += fraction * (index % base);
    }
    return value;
  };
  std::array<SE3, 32> out;
  for (unsigned i = 0; i < out.size(); ++i) {
    const double scale = std::pow(10.0, 1.5 * halton(i + 1, k_bases[6]));  // 1 to 30
    Twist xi;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const double unit = 2 * halton(i + 1, k_bases[axis]) - 1;
      xi[static_cast<Eigen::Index>(axis)] =
          unit * scale * (axis < 3 ? 1.0 : 0.003);  // mm, rad: a joint's calibration
    }
    out[i] = T_base_flange * geometry::exp_se3(xi);
  }
  return out;
}

/// Collects the solutions of one pose.
class Search {
 public:
  Search(const ArmModel& arm, const SE3& T_base_flange) : arm_{arm}, T_base_flange_{T_base_flange} {}

  /// From the seed, and where that does not arrive from both sides of the folds beside it and beside where it
  /// ended.
  void from(const Solution& seed) {
    const Refined end = refined(arm_, seed.q_rad, T_base_flange_);
    if (end.met) return add(end, seed.branch);
    for (const Joints& beside_rad : {seed.q_rad, end.q_rad}) from_fold(beside_rad, k_least, seed.branch);
  }

  /// The twins of all solutions so far, and of these, across the folds beside them.
  void add_twins() {
    for (std::size_t i = 0; i < solutions_.size(); ++i) {
      const Solution known = solutions_[i];
      for (const int which : {k_least, k_least - 1})
        from_fold(known.q_rad, which, known.branch);  // two may be near
    }
  }

  [[nodiscard]] const Solutions& solutions() const { return solutions_; }

 private:
  static constexpr int k_least = 5;  // singular values come largest first

  void from_fold(const Joints& beside_rad, int which, Branch branch) {
    for (const Solution& start : across_fold(arm_, beside_rad, T_base_flange_, which)) {
      const Refined found = refined(arm_, start.q_rad, T_base_flange_);
      if (found.met) add(found, branch);
    }
  }

  void add(const Refined& found, Branch branch) {
    if (!solutions_.full() && !is_among(solutions_, found.q_rad))
      solutions_.add({.q_rad = found.q_rad, .branch = branch});
  }

  const ArmModel& arm_;
  const SE3& T_base_flange_;
  Solutions solutions_;
};

Solutions inverse_calibrated(const ArmModel& arm, const SE3& T_base_flange, const InverseOptions& options) {
  Search search{arm, T_base_flange};
  const auto from_nominal = [&](const SE3& T_seed) {
    const ClosedFormOptions closed{.slack = k_calibrated_slack, .q6_hint_rad = options.q6_hint_rad};
    for (const Solution& seed : inverse_nominal(arm.nominal, T_seed, closed)) search.from(seed);
  };
  from_nominal(T_base_flange);
  if (options.search_folds && near_a_fold(arm.nominal, T_base_flange)) {
    for (const SE3& T_seed : around(T_base_flange)) from_nominal(T_seed);
    search.add_twins();
  }
  return search.solutions();
}

}  // namespace

Solutions inverse(const ArmModel& arm, const SE3& T_base_flange, const InverseOptions& options) {
  if (arm.calibrated) return inverse_calibrated(arm, T_base_flange, options);
  return inverse_nominal(arm.nominal, T_base_flange,
                         {.slack = k_rounding, .q6_hint_rad = options.q6_hint_rad});
}

double nearest_turn(double angle_rad, double reference_rad) {
  return reference_rad + std::remainder(angle_rad - reference_rad, 2 * k_pi);
}

Joints nearest_turns(Joints q_rad, const Joints& reference_rad, const JointLimits& limits,
                     double margin_rad) {
  constexpr double k_whole_rad = 2 * k_pi;
  for (int joint = 0; joint < 6; ++joint) {
    if (joint == k_elbow) continue;
    double& angle_rad = q_rad[joint];
    angle_rad = nearest_turn(angle_rad, reference_rad[joint]);
    const double over_rad = angle_rad - (limits.maximum_rad[joint] - margin_rad),
                 under_rad = limits.minimum_rad[joint] + margin_rad - angle_rad;
    if (over_rad > 0) angle_rad -= k_whole_rad * std::ceil(over_rad / k_whole_rad);
    if (under_rad > 0) angle_rad += k_whole_rad * std::ceil(under_rad / k_whole_rad);
  }
  return q_rad;
}

}  // namespace biteline::kinematics
