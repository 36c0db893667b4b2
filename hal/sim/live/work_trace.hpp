// SPDX-License-Identifier: MIT
#pragma once
/// \file What the arm's tool leaves on the simulated shoe, by where it was and whether its output was on.

#include <optional>
#include <vector>

#include "hal/sim/glue/glue_gun.hpp"
#include "hal/sim/record/made_scene.hpp"
#include "hal/sim/robot/arm.hpp"

namespace biteline::sim {

/// The tool, and the output that it hangs on.
struct WorkingTool {
  Work work{Work::WetGlue};
  std::uint64_t film_seed{1};
  int digital_output{0};
  double width_mm{8};     ///< on the surface, across its way
  double standoff_mm{0};  ///< of the place that is worked, from the tip along its axis
  GunFacts gun{.metered = false};
  /// Nothing comes out over this part of the outline in the first `gap_programs` programs that switch it on.
  std::optional<OutlinePart> gap{};
  int gap_programs{1};
};

/// The tool works on the surface nearest to its tip, or to so far along its axis: no ray of a spray is
/// followed, and a place farther from the surface than k_reach_mm gets nothing.  A layer is as thick at any
/// speed. Thread: step() the controller's, lay() any other; one at a time, as the owner sees to.
class WorkTrace {
 public:
  WorkTrace(const PlacedShoe& unworked, const WorkingTool& tool);

  /// One cycle.  `T_base_flange`: where the flange really is.  Memory grows with the worked way.
  void step(const ArmState& state, const SE3& T_base_flange, double step_s);
  /// The program has ended, and it has worked something that lay() has not laid yet.
  [[nodiscard]] bool due() const { return due_; }
  /// The shoe with all that was worked so far.
  [[nodiscard]] MadeShoe lay();

  static constexpr double k_reach_mm = 6;
  static constexpr double k_station_mm = 0.1;

 private:
  struct Spot {
    Vec3 place_shoe{Vec3::Zero()};
    float out_ratio{0};   ///< of what the tool gives when it is open
    bool goes_on{false};  ///< from the spot before it, without a break
    bool blocked{false};  ///< a part of the outline gets nothing
  };
  struct OnOutline {
    double s_mm, z_mm;
  };
  [[nodiscard]] std::optional<OnOutline> on_outline(const Vec3& place_shoe) const;
  void lay_between(const OnOutline& from, const OnOutline& to, const Spot& spot);

  MadeShoe shoe_;
  std::vector<TrueLinePoint> line_;
  SE3 T_shoe_base_;
  WorkingTool tool_;
  GlueGun gun_;
  bool ran_{false}, due_{false}, worked_{false}, before_{false};
  int programs_{0};  ///< that have switched it on
  std::vector<Spot> spots_;
  std::vector<float> laid_;   ///< layers at each station
  std::vector<double> z_mm_;  ///< of the place that was worked there last
};

}  // namespace biteline::sim
