// SPDX-License-Identifier: MIT
#include "biteline/plan.hpp"

#include "host/library/source/inside.hpp"
#include "host/robot/path/path_file.hpp"
#include "host/robot/path/plan.hpp"

namespace biteline::sdk {

struct Path::State {
  path::CheckedPath path;
  std::vector<Waypoint> waypoints;
};

namespace {

Waypoint from_inside(const path::Waypoint& waypoint) {
  Waypoint out{.T_base_tcp = Motion{waypoint.T_base_tcp.matrix()},
               .segment = path::name_of(waypoint.segment),
               .time_s = waypoint.time_s,
               .speed_mm_s = waypoint.speed_mm_s,
               .u95_mm = waypoint.u95_mm};
  std::copy(waypoint.q_rad.begin(), waypoint.q_rad.end(), out.joints_rad.begin());
  return out;
}

path::PlanRequest to_inside(const PlanRequest& request) {
  path::PlanRequest inside;
  inside.line = to_inside(request.line);
  inside.process = or_throw(path::read_process(request.process_file));
  inside.arm = or_throw(kinematics::arm_model(request.robot));
  inside.T_line_base = SE3{request.T_line_base.matrix()};
  const Mat3 R = inside.T_line_base.linear();
  if (!inside.T_line_base.matrix().allFinite() || !(R * R.transpose()).isIdentity(1e-6) ||
      R.determinant() < 0)
    throw Error{"T_line_base: no rigid motion", "give a rotation and a translation in mm"};
  inside.table_z_mm = request.table_z_mm;
  if (request.cloud) inside.cloud = request.cloud->state().cloud.points;
  if (request.from_rad) inside.from_rad = Eigen::Map<const kinematics::Joints>(request.from_rad->data());
  return inside;
}

}  // namespace

Path::Path(std::shared_ptr<const State> state) : state_{std::move(state)} {}
double Path::duration_s() const {
  return state_->path.duration_s();
}
const std::vector<Waypoint>& Path::waypoints() const {
  return state_->waypoints;
}
void Path::write_csv(const std::filesystem::path& file) const {
  or_throw(path::write_path(file, state_->path));
}

Path plan(const PlanRequest& request) {
  path::PlanOutcome outcome = path::plan(to_inside(request));
  if (!outcome.path) throw_refusal(report::told(*outcome.refusal));
  Path::State state{.path = std::move(*outcome.path), .waypoints = {}};
  for (const path::Waypoint& waypoint : state.path.path().waypoints)
    state.waypoints.push_back(from_inside(waypoint));
  return Path{std::make_shared<const Path::State>(std::move(state))};
}

}  // namespace biteline::sdk
