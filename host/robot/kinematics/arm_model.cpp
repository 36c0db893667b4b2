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
  DhLengths lengths;
  LinkShape shape;
  std::array<double, k_joints> speed_deg_s;
};

// Lengths: Universal Robots, "DH parameters for calculations of kinematics and dynamics".
// Speeds: the arms' user manuals.  Shapes: diameters and offsets of the manuals' drawings, rounded up.
constexpr std::array k_rows{
    Row{"UR3e",
        {151.85, -243.55, -213.2, 131.05, 85.35, 92.1},
        {120, 27, 75, 45, 40, 40},
        {180, 180, 180, 360, 360, 360}},
    Row{"UR5e",
        {162.5, -425, -392.2, 133.3, 99.7, 99.6},
        {138, 7, 75, 60, 50, 45},
        {180, 180, 180, 180, 180, 180}},
    Row{"UR10e",
        {180.7, -612.7, -571.55, 174.15, 119.85, 116.55},
        {176.2, 39.3, 95, 75, 60, 55},
        {120, 120, 180, 180, 180, 180}},
    Row{"UR3",
        {151.9, -243.65, -213.25, 112.35, 85.35, 81.9},
        {119.8, 27, 75, 45, 40, 40},
        {180, 180, 180, 360, 360, 360}},
    Row{"UR5",
        {89.159, -425, -392.25, 109.15, 94.65, 82.3},
        {135.85, 16.5, 75, 60, 50, 45},
        {180, 180, 180, 180, 180, 180}},
    Row{"UR10",
        {127.3, -612, -572.3, 163.941, 115.7, 92.2},
        {176.2, 45, 95, 75, 60, 55},
        {120, 120, 180, 180, 180, 180}},
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
                    .nominal = row.lengths,
                    .T_fixed = nominal_frames(row.lengths),
                    .calibrated = false,
                    .limits = limits_of(row),
                    .shape = row.shape,
                    .give = joint_give(k_assumed_hz, false)};
  }
  std::string known;
  for (const Row& row : k_rows) known += std::string{known.empty() ? "" : ", "} + row.name;
  const std::string asked{name};
  return fail(Errc::InvalidArgument, "robot %.40s is unknown; known: %s", asked.c_str(), known.c_str());
}

std::vector<std::string> arm_names() {
  std::vector<std::string> names;
  for (const Row& row : k_rows) names.emplace_back(row.name);
  return names;
}

}  // namespace biteline::kinematics
