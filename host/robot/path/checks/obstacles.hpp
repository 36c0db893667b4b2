// SPDX-License-Identifier: MIT
#pragma once
/// \file What the arm and its tool must not touch: the table, the shoe, the arm itself.

#include <optional>
#include <string>
#include <vector>

#include "host/cloud/closed_line.hpp"
#include "host/robot/kinematics/arm_shape.hpp"
#include "host/robot/path/checks/point_blocks.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::path {

/// What the shoe stands on above the table (fixture.hpp), seen from above.
struct FixtureBlock {
  double top_z_mm{0};
  std::vector<Vec2> outline;
};

/// Table, fixture and shoe in base.
struct Surroundings {
  double table_z_mm{0};
  std::vector<Vec3>
      shoe_points;  ///< surface and inside, the fixture's too, `shoe_spacing_mm` apart or closer
  double shoe_spacing_mm{8};
  std::optional<FixtureBlock> fixture{};
};

/// What is known of a shoe from its line alone: the sole below it, `overhang_mm` wide, the upper above it,
/// leaning in along the normals, `height_mm` high, both filled.
struct ShoeGuess {
  double overhang_mm{4};
  double height_mm{90};
};
[[nodiscard]] Surroundings surroundings_of_line(const cloud::ClosedLine& line, const ShoeGuess& guess,
                                                double table_z_mm);

/// The same with the shoe's own scan in place of the guessed upper (what lies more than 3 mm above the
/// table).
void replace_shoe(Surroundings& surroundings, const std::vector<Eigen::Vector3f>& cloud_base);

/// The closest pair of one arm pose, negative when they overlap.
struct Clearance {
  double mm{1e9};
  const char* what{""};  ///< "tool and shoe"
};

/// Capsules against capsules, plane and points.  Thread: const, any.
class CollisionModel {
 public:
  CollisionModel(const kinematics::ArmModel& arm, const Tool& tool, Surroundings surroundings);

  /// `enough_mm`: clearances beyond that are not told apart (faster).
  [[nodiscard]] Clearance clearance(const std::array<SE3, kinematics::k_joints>& T_base_joint,
                                    double enough_mm) const;
  /// Of the tool's axis from its body to its tip, which may come close to the shoe where it works alone.
  [[nodiscard]] Clearance tip_clearance(const SE3& T_base_flange, double enough_mm) const;

  [[nodiscard]] const Surroundings& surroundings() const { return surroundings_; }

 private:
  [[nodiscard]] double to_shoe_mm(const kinematics::Capsule& capsule, double enough_mm) const;

  std::array<kinematics::LinkCapsule, kinematics::k_link_capsules> links_;
  kinematics::Capsule tool_flange_, tip_flange_;
  Surroundings surroundings_;
  PointBlocks shoe_;
  Eigen::AlignedBox3d shoe_box_;
};

/// Between the axes of two capsules, less their radii.
[[nodiscard]] double distance_mm(const kinematics::Capsule& a, const kinematics::Capsule& b);

}  // namespace biteline::path
