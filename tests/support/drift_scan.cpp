// SPDX-License-Identifier: MIT
#include "tests/support/drift_scan.hpp"

#include <algorithm>
#include <cmath>

#include "hal/sim/live/reachable_scan.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::test {
namespace {

constexpr double k_rate_hz = 100;
constexpr double k_waist_ratio = 0.25;
/// Neighbouring poses are off alike: what stays from one profile to the next of the slow part, and how large
/// that is beside the white one.
constexpr double k_stays = 0.9, k_slow = 0.4;

/// Errors of the poses along the way: white noise and a first-order process.
class PoseError {
 public:
  PoseError(sim::Random& random, double mm, double rad) : random_{random}, mm_{mm}, rad_{rad} {
    for (double& value : state_) value = random_.gaussian();
  }
  SE3 next() {
    for (double& value : state_)
      value = k_stays * value + std::sqrt(1 - k_stays * k_stays) * random_.gaussian();
    Twist off = k_slow * state_;
    for (double& value : off) value += random_.gaussian();
    off.head<3>() *= mm_;
    off.tail<3>() *= rad_;
    return geometry::exp_se3(off);
  }

 private:
  sim::Random& random_;
  double mm_, rad_;
  Twist state_{Twist::Zero()};
};

/// How far beside a shining place a stripe is seen falsely, and by how much (one sigma).
constexpr double k_shines_mm = 6, k_shines_px = 25;

/// The first part of the line, in the shoe's frame.
bool shines(const std::vector<sim::TrueLinePoint>& line, double ratio, const Vec3& point_shoe) {
  const auto count = static_cast<std::ptrdiff_t>(ratio * static_cast<double>(line.size()));
  return std::any_of(line.begin(), line.begin() + count, [&](const sim::TrueLinePoint& on_line) {
    return (on_line.point_shoe - point_shoe).norm() < k_shines_mm;
  });
}

}  // namespace

Result<DriftCell> DriftCell::make(const Settings& settings) {
  sim::SceneSettings scene_settings{
      .shoe = sim::draw_shoe(settings.shoe_class, settings.shoe_seed, sim::length_of_size_mm(settings.size)),
      .place_seed = settings.shoe_seed,
      .places = sim::places_within_reach_of("ur10e"),
      .head_seed = settings.head_seed,
      .holder = sim::Holder::Bracket,
      .scan_speed_mm_s = settings.speed_mm_s,
      .scan_begin_ratio = settings.takt ? k_waist_ratio : 0,
      .scan_clockwise = settings.takt,
      .rate_hz = k_rate_hz,
      .check = settings.check,
      .surroundings = settings.table,
      .fineness = {.column_mm = 0.5, .fine_row_mm = 0.3, .fine_band_mm = 4.5, .coarse_row_mm = 0.4}};
  BITELINE_ASSIGN(std::unique_ptr<sim::MadeScene> scene, sim::make_scene(scene_settings));
  const auto arm = sim::ArmKinematics::named("ur10e");
  BITELINE_ASSIGN(const sim::ReachableScan reachable, sim::place_within_reach(*scene, *arm, "ur10e"));
  DriftCell cell;
  cell.fan_rays_ = settings.fan_rays;
  cell.way_ =
      sim::way_of(*reachable.scan, *arm, settings.real ? sim::common_arm_dynamics() : sim::ArmDynamics{});
  cell.last_profile_s_ = reachable.scan->full_until_s();
  cell.rest_to_rest_s_ = reachable.scan->duration_s();
  cell.scene_ = std::move(scene);
  return cell;
}

std::vector<DriftCell::Look> DriftCell::looks(const Setting& setting) const {
  const sim::MadeHead& head = scene_->head;
  const geometry::SensorModel actual =
      uncertainty::perturbed(head.model, drift::axes_of(head.model), drift::parameters_of(setting.drifted));
  // The laser's own rays, in the plane where it shines now.
  const Vec3& n = actual.laser_plane.normal_cam;
  const Vec3 emitter_cam =
      head.laser.emitter_cam - actual.laser_plane.signed_distance_mm(head.laser.emitter_cam) * n;
  const Vec3 beam_cam = (head.laser.beam_cam - n.dot(head.laser.beam_cam) * n).normalized();
  const Vec3 across_cam = beam_cam.cross(n);
  const SE3 T_shoe_base = (scene_->T_base_shoe * setting.T_shoe_put).inverse();
  sim::Random glare(scene_->settings.place_seed);
  std::vector<Look> seen;
  const auto frames = static_cast<std::uint32_t>(way_.duration_s * k_rate_hz);
  for (std::uint32_t k = 0; k < frames; ++k) {
    const SE3 T_shoe_cam = T_shoe_base * way_.T_base_flange_at(k / k_rate_hz) * actual.T_flange_cam;
    const Vec3 emitter = T_shoe_cam * emitter_cam, eye = T_shoe_cam.translation();
    for (int ray = 0; ray < fan_rays_; ++ray) {
      const double across = std::tan(head.laser.fan_half_rad) * (2.0 * ray / (fan_rays_ - 1) - 1);
      const Vec3 along = T_shoe_cam.linear() * (beam_cam + across * across_cam).normalized();
      const auto hit = scene_->scene.first_hit(emitter, along);
      if (!hit) continue;
      const Vec3 point = emitter + hit->distance_mm * along;
      if (!scene_->scene.sees(eye, point)) continue;
      Vec2 pixel = actual.camera.project(T_shoe_cam.inverse() * point);
      if (shines(scene_->line, setting.shining_ratio, point)) pixel.y() += k_shines_px * glare.gaussian();
      const geometry::Region& region = head.model.region;
      if (pixel.x() < 0 || pixel.x() >= region.width_px || pixel.y() < region.offset_v_px ||
          pixel.y() >= region.offset_v_px + region.height_px)
        continue;
      seen.push_back({.profile = k, .pixel = pixel});
    }
  }
  return seen;
}

DriftScan DriftCell::scan(const std::vector<Look>& looks, const Draw& draw) const {
  sim::Random random(draw.seed ^ 0x4452494654ULL);
  const geometry::SensorModel& model = scene_->head.model;
  PoseError pose_error(random, draw.pose_mm, draw.pose_rad);
  DriftScan made;
  const auto frames = static_cast<std::uint32_t>(way_.duration_s * k_rate_hz);
  for (std::uint32_t k = 0; k < frames; ++k) {
    const double time_s = k / k_rate_hz;
    const SE3 told = way_.T_base_flange_told_at(time_s - draw.late_s) * pose_error.next();
    made.poses.push_back({.profile = k, .pose = {.T_base_flange = told, .time_s = time_s}});
  }
  for (const Look& look : looks) {
    const Vec2 pixel = look.pixel + Vec2{0, draw.noise_px * random.gaussian()};
    const Vec3 seen_cam = geometry::triangulate(model.camera, model.laser_plane, pixel);
    const SE3& told = made.poses[look.profile].pose.T_base_flange;
    made.points_base.push_back((told * model.T_flange_cam * seen_cam).cast<float>());
    made.profile.push_back(look.profile);
  }
  return made;
}

}  // namespace biteline::test
