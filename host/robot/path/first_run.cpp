// SPDX-License-Identifier: MIT
#include "host/robot/path/first_run.hpp"

#include <algorithm>

namespace biteline::path {
namespace {

double slowed_mm_s(double speed_mm_s) {
  return std::max(k_first_run_speed_ratio * speed_mm_s, std::min(speed_mm_s, k_first_run_least_mm_s));
}

}  // namespace

PlanRequest first_run(PlanRequest request) {
  Process& process = request.process;
  process.placement.up_mm += k_first_run_lift_mm;
  process.placement.outward_mm += k_first_run_out_mm;
  Motion& motion = process.motion;
  const double line_mm_s = motion.speed_mm_s;
  for (double* speed_mm_s : {&motion.speed_mm_s, &motion.approach_speed_mm_s, &motion.transfer_speed_mm_s})
    *speed_mm_s = slowed_mm_s(*speed_mm_s);
  for (double* speed : {&motion.minimum_speed_mm_s, &motion.joint_speed_ratio, &motion.way_there_rad_s})
    *speed *= k_first_run_speed_ratio;
  for (Zone& zone : process.zones)
    zone.speed_ratio = slowed_mm_s(zone.speed_ratio * line_mm_s) / motion.speed_mm_s;
  process.follow.stall_s = std::max(process.follow.stall_s, FollowLimits{}.stall_s);
  motion.transfer_speed_mm_s = std::min(motion.transfer_speed_mm_s, motion.approach_speed_mm_s);
  request.tool_off = true;
  request.least_tip_to_shoe_mm = k_first_run_clear_mm;
  return request;
}

PlanRequest force_air_run(PlanRequest request) {
  request.process.placement.outward_mm += k_force_air_out_mm;
  request.tool_off = true;
  return request;
}

}  // namespace biteline::path
