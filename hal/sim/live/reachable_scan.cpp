// SPDX-License-Identifier: MIT
#include "hal/sim/live/reachable_scan.hpp"

#include <array>

namespace biteline::sim {

Result<ReachableScan> place_within_reach(MadeScene& scene, const ArmKinematics& kinematics,
                                         const std::string& arm) {
  constexpr std::uint64_t k_places = 20;
  constexpr std::array k_raised_mm = {0.0, 10.0, 20.0};  // the stripe is long enough
  const SceneSettings& settings = scene.settings;
  const ScanPath low = scene.path;
  std::string first_reason;
  for (const double raised_mm : k_raised_mm) {
    ScanPathSettings path = low.settings();
    path.target_z_mm += raised_mm;
    scene.path = ScanPath(low.outline(), scene.head, path);
    for (std::uint64_t i = 0; i < k_places; ++i) {
      constexpr std::uint64_t k_next_place = 7919;  // far from the seeds that people count up
      scene.T_base_shoe = draw_place(settings.place_seed + i * k_next_place, settings.places,
                                     settings.shoe.outline.length_mm);
      auto scan = ArmScan::plan(scene.path, scene.head, kinematics,
                                {.T_base_shoe = scene.T_base_shoe,
                                 .top_z_mm = settings.shoe.upper.top_z_mm,
                                 .clockwise = settings.scan_clockwise});
      if (scan) return ReachableScan{std::make_shared<const ArmScan>(std::move(*scan)), first_reason};
      if (first_reason.empty()) first_reason = to_line(scan.error());
    }
  }
  scene.path = low;
  return fail(
      Errc::OutOfReach,
      "%s does not take the head round this shoe of %.0f mm at %d places tried, up to %.0f mm higher (%s)",
      arm.c_str(), settings.shoe.outline.length_mm, int{k_places}, k_raised_mm.back(), first_reason.c_str());
}

}  // namespace biteline::sim
