// SPDX-License-Identifier: MIT
#pragma once
/// \file A checked path of a robot along a line.  This library moves no robot.

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "biteline/cloud.hpp"
#include "biteline/export.hpp"
#include "biteline/line.hpp"
#include "biteline/motion.hpp"

namespace biteline::sdk {

using Joints = std::array<double, 6>;  ///< rad, from the base to the last wrist

struct PlanRequest {
  Line line;
  std::filesystem::path process_file;      ///< tool, placement, motion (docs/robot-path.md)
  std::string robot;                       ///< "UR10e"; an unknown name's Error lists the known ones
  Motion T_line_base{Motion::Identity()};  ///< the arm's base in the line's frame
  double table_z_mm{0};                    ///< height of the table in the line's frame
  std::optional<Cloud> cloud{};            ///< of the shoe, for collisions; else it is guessed from the line
  std::optional<Joints> from_rad{};        ///< where the arm stands: its way to the path is checked, too
};

struct Waypoint {
  Motion T_base_tcp;
  Joints joints_rad{};
  std::string segment;  ///< "approach", "line", "retreat", "travel"
  double time_s{0};
  double speed_mm_s{0};            ///< of the tip
  std::optional<double> u95_mm{};  ///< of the tip's place across its way, on the line, if known
};

/// A path that passed every check: reach, joint limits, singularities, speeds, collisions.
class BITELINE_API Path {
 public:
  struct State;  ///< of the library

  explicit Path(std::shared_ptr<const State> state);
  [[nodiscard]] double duration_s() const;
  [[nodiscard]] const std::vector<Waypoint>& waypoints() const;
  /// path.csv (docs/formats.md).  Throws Error.
  void write_csv(const std::filesystem::path& file) const;

 private:
  std::shared_ptr<const State> state_;
};

/// Throws Refused where no path passes the checks, and Error for a fault of the process file.
[[nodiscard]] BITELINE_API Path plan(const PlanRequest& request);

}  // namespace biteline::sdk
