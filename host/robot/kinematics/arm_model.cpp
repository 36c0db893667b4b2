// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/arm_model.hpp"

#include <algorithm>
#include <cctype>
#include <numbers>

namespace biteline::kinematics {
namespace {

constexpr double k_rad_per_deg = std::numbers::pi / 180;

struct Row {
  const char* name;
  Controller controller;
  DhLengths lengths;
  LinkShape shape;
  std::array<double, k_joints> speed_deg_s;
};

constexpr DhLengths k_ur5e{162.5, -425, -392.2, 133.3, 99.7, 99.6};
constexpr DhLengths k_ur10e{180.7, -612.7, -571.55, 174.15, 119.85, 116.55};
constexpr LinkShape k_shape_ur5e{138, 7, 75, 60, 50, 45};
constexpr LinkShape k_shape_ur10e{176.2, 39.3, 95, 75, 60, 55};
constexpr LinkShape k_shape_ur20{260, 43, 123, 91, 76, 60};
constexpr std::array<double, k_joints> k_slow{120, 120, 180, 180, 180, 180};
constexpr std::array<double, k_joints> k_slowest{120, 120, 150, 210, 210, 210};

// Lengths: Universal Robots, "DH parameters for calculations of kinematics and dynamics"; of UR16e, UR20 and
// UR30 as in its description package for ROS 2, as are their joints' speeds and offsets.  A UR7e is built as
// a UR5e, and a UR12e as a UR10e (the same package; its client library).
// Speeds: the arms' user manuals.  Shapes: diameters and offsets of the manuals' drawings, rounded up; of
// UR16e, UR20 and UR30 the extents of that package's collision bodies.
constexpr std::array k_rows{
    Row{"UR3e",
        {"UR3", false},
        {151.85, -243.55, -213.2, 131.05, 85.35, 92.1},
        {120, 27, 75, 45, 40, 40},
        {180, 180, 180, 360, 360, 360}},
    Row{"UR5e", {"UR5", false}, k_ur5e, k_shape_ur5e, {180, 180, 180, 180, 180, 180}},
    Row{"UR7e", {"UR5", false}, k_ur5e, k_shape_ur5e, {180, 180, 180, 180, 180, 180}},
    Row{"UR10e", {"UR10", false}, k_ur10e, k_shape_ur10e, k_slow},
    Row{"UR12e", {"UR10", false}, k_ur10e, k_shape_ur10e, k_slow},
    Row{"UR16e",
        {"UR16", false},
        {180.7, -478.4, -360, 174.15, 119.85, 116.55},
        {176, 40, 95, 77, 60, 55},
        k_slow},
    Row{"UR20", {"UR20", false}, {236.3, -862, -728.7, 201, 159.3, 154.3}, k_shape_ur20, k_slowest},
    Row{"UR30", {"UR30", false}, {236.3, -637, -503.7, 201, 159.3, 154.3}, k_shape_ur20, k_slowest},
    Row{"UR3",
        {"UR3", true},
        {151.9, -243.65, -213.25, 112.35, 85.35, 81.9},
        {119.8, 27, 75, 45, 40, 40},
        {180, 180, 180, 360, 360, 360}},
    Row{"UR5",
        {"UR5", true},
        {89.159, -425, -392.25, 109.15, 94.65, 82.3},
        {135.85, 16.5, 75, 60, 50, 45},
        {180, 180, 180, 180, 180, 180}},
    Row{"UR10",
        {"UR10", true},
        {127.3, -612, -572.3, 163.941, 115.7, 92.2},
        {176.2, 45, 95, 75, 60, 55},
        k_slow},
};

// The makers publish none; 5 rad/s^2 is what the controllers of both series follow with a full payload.
constexpr double k_acceleration_rad_s2 = 5;

// No maker tells one, either.  Arms of this kind swing at 8 to 20 Hz.
constexpr double k_assumed_hz = 8;

JointLimits limits_of(const Row& row) {
  JointLimits limits;
  // Every joint turns twice, but the elbow's links meet near pi.
  limits.maximum_rad.setConstant(2 * std::numbers::pi);
  limits.maximum_rad[2] = std::numbers::pi;
  limits.minimum_rad = -limits.maximum_rad;
  for (int i = 0; i < 6; ++i)
    limits.speed_rad_s[i] = row.speed_deg_s[static_cast<std::size_t>(i)] * k_rad_per_deg;
  limits.acceleration_rad_s2.setConstant(k_acceleration_rad_s2);
  return limits;
}

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(
      a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

}  // namespace

std::array<SE3, k_joints> nominal_frames(const DhLengths& lengths) {
  const auto frame = [](const Vec3& translation_mm, double roll_rad) {
    SE3 T = SE3::Identity();
    T.linear() = Eigen::AngleAxisd(roll_rad, Vec3::UnitX()).toRotationMatrix();
    T.translation() = translation_mm;
    return T;
  };
  constexpr double quarter = std::numbers::pi / 2;
  return {frame({0, 0, lengths.d1_mm}, 0),        frame({0, 0, 0}, quarter),
          frame({lengths.a2_mm, 0, 0}, 0),        frame({lengths.a3_mm, 0, lengths.d4_mm}, 0),
          frame({0, -lengths.d5_mm, 0}, quarter), frame({0, lengths.d6_mm, 0}, -quarter)};
}

JointGive joint_give(double softest_hz, bool measured) {
  JointGive give{.natural_hz = {}, .measured = measured};
  give.natural_hz << 1.1, 1.0, 1.3, 1.8, 2.2, 2.5;
  give.natural_hz *= softest_hz;
  return give;
}

Result<ArmModel> arm_model(std::string_view name) {
  for (const Row& row : k_rows) {
    if (!same_word(row.name, name)) continue;
    return ArmModel{.name = row.name,
                    .controller = row.controller,
                    .nominal = row.lengths,
                    .T_fixed = nominal_frames(row.lengths),
                    .calibrated = false,
                    .limits = limits_of(row),
                    .shape = row.shape,
                    .give = joint_give(k_assumed_hz, false)};
  }
  const std::string asked{name};
  return fail(Errc::InvalidArgument, "robot %.40s is unknown; known: %s", asked.c_str(),
              known_arms().c_str());
}

bool is_told_as(const ArmModel& arm, std::string_view told) {
  if (same_word(arm.name, told) || same_word(arm.controller.says, told)) return true;
  // A UR5e's may be told with its letter, too.
  const bool e_series = !arm.controller.cb3 && !told.empty() && std::tolower(told.back()) == 'e';
  return e_series && same_word(arm.controller.says, told.substr(0, told.size() - 1));
}

std::string known_arms() {
  std::string known;
  for (const Row& row : k_rows) known += std::string{known.empty() ? "" : ", "} + row.name;
  return known;
}

std::vector<std::string> arm_names() {
  std::vector<std::string> names;
  for (const Row& row : k_rows) names.emplace_back(row.name);
  return names;
}

}  // namespace biteline::kinematics
