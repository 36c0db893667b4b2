// SPDX-License-Identifier: MIT
#include "hal/sim/live/reachable_scan.hpp"

namespace biteline::sim {

Result<ReachableScan> place_within_reach(MadeScene& scene, const ArmKinematics& kinematics,
                                         const std::string& arm) {
  constexpr std::uint64_t k_places = 20;
  const SceneSettings& settings = scene.settings;
  std::string first_reason;
  for (std::uint64_t i = 0; i < k_places; ++i) {
    constexpr std::uint64_t k_next_place = 7919;  // far from the seeds that people count up
    if (i > 0) {
      scene.T_base_shoe = draw_place(settings.place_seed + i * k_next_place, settings.places,
                                     settings.shoe.outline.length_mm);
    }
    auto scan = ArmScan::plan(scene.path, scene.head, kinematics,
                              {.T_base_shoe = scene.T_base_shoe,
                               .top_z_mm = settings.shoe.upper.top_z_mm,
                               .clockwise = settings.scan_clockwise});
    if (scan) return ReachableScan{std::make_shared<const ArmScan>(std::move(*scan)), first_reason};
    if (i == 0) first_reason = to_line(scan.error());
  }
  return fail(Errc::OutOfReach,
              "%s does not take the head round this shoe of %.0f mm at %d places tried (%s)", arm.c_str(),
              settings.shoe.outline.length_mm, int{k_places}, first_reason.c_str());
}

}  // namespace biteline::sim
