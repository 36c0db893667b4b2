// SPDX-License-Identifier: MIT
#include "tests/bench/tip/scan.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/pipeline/profile_pipeline.hpp"
#include "hal/sim/record/disturbances.hpp"
#include "hal/sim/record/surroundings.hpp"
#include "hal/sim/shoe/random.hpp"
#include "host/intake/cloud_builder.hpp"
#include "host/intake/live_line.hpp"

namespace biteline::bench {
namespace {

constexpr double k_pose_rate_hz = 500;

SensorClock::time_point instant(double time_s) {
  return SensorClock::time_point{Nanoseconds{std::llround(time_s * 1e9)}};
}

/// Exposures' middles, from the way's begin on.
std::vector<double> frame_times_s(const TipScan& scan) {
  std::vector<double> times_s;
  const double period_s = 1 / scan.scene->settings.rate_hz;
  for (double t = scan.way->full_from_s(); t < scan.way->full_until_s(); t += period_s) times_s.push_back(t);
  return times_s;
}

/// Told poses up to some time, as a bus brings them.
class ToldPoses {
 public:
  ToldPoses(const TipScan& scan, const Variant& variant)
      : scan_{scan},
        variant_{variant},
        random_{sim::Random{scan.cell.seed}.fork(14)},
        late_s_{scan.cell.clock_error_s(variant.sources)} {}

  void push_until(double time_s) {
    for (; next_s_ < time_s; next_s_ += 1 / k_pose_rate_hz)
      history_->rt_push({.stamp = instant(next_s_ + late_s_), .T_base_flange = told(next_s_)});
  }
  [[nodiscard]] const pipeline::PoseHistory& history() const { return *history_; }

 private:
  SE3 told(double time_s) {
    const JointRun::Row row = scan_.joints.at(time_s);
    const Sources& sources = variant_.sources;
    const sim::JointVector& q_rad = sources.give ? row.q_told_rad : row.q_link_rad;
    const SE3 T_base_flange = sources.links
                                  ? scan_.cell.arm.controller(variant_.reckoning).T_base_flange(q_rad)
                                  : scan_.cell.arm.T_base_flange(q_rad, false);
    Twist noise = Twist::Zero();
    for (int i = 0; i < 6 && sources.give; ++i)
      noise[i] = (i < 3 ? k_told_sigma_mm : k_told_sigma_rad) * random_.gaussian();
    return T_base_flange * geometry::exp_se3(noise);
  }

  const TipScan& scan_;
  const Variant& variant_;
  sim::Random random_;
  double late_s_, next_s_{0};
  std::unique_ptr<pipeline::PoseHistory> history_{std::make_unique<pipeline::PoseHistory>()};
};

}  // namespace

JointRun::Row JointRun::at(double time_s) const {
  const double place = std::clamp(time_s / k_step_s, 0.0, static_cast<double>(rows_.size() - 2));
  const auto i = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(i);
  const Row &a = rows_[i], &b = rows_[i + 1];
  return {.q_told_rad = a.q_told_rad + part * (b.q_told_rad - a.q_told_rad),
          .q_link_rad = a.q_link_rad + part * (b.q_link_rad - a.q_link_rad)};
}

Result<TipScan> make_scan(const ScanSettings& settings) {
  constexpr double k_scan_begin_ratio = 0.25;  // in the waist, where the wrist is slow
  BITELINE_ASSIGN(auto scene, sim::make_scene({.shoe = settings.shoe,
                                               .place_seed = settings.seed,
                                               .places = sim::places_within_reach_of(k_tip_arm),
                                               .head_seed = settings.seed,
                                               .holder = sim::Holder::Bracket,
                                               .scan_speed_mm_s = settings.speed_mm_s,
                                               .scan_begin_ratio = k_scan_begin_ratio,
                                               .scan_clockwise = true,
                                               .rate_hz = settings.rate_hz,
                                               .ambient_grey = sim::k_hall_grey,
                                               .surroundings = true}));
  TipCell cell = draw_cell(settings.seed, scene->head);
  BITELINE_ASSIGN(const sim::ReachableScan reachable,
                  sim::place_within_reach(*scene, cell.arm.controller(Reckoning::Own), k_tip_arm));
  JointRun joints{dynamics_of({}), reachable.scan->duration_s(),
                  [&](double time_s) { return reachable.scan->q_rad_at(time_s); }};
  return TipScan{
      .scene = std::move(scene), .way = reachable.scan, .cell = std::move(cell), .joints = std::move(joints)};
}

Pictures pictures_of(const TipScan& scan, bool light) {
  sim::MadeHead head = scan.scene->head;
  head.laser.coherent = light;
  const geometry::Region& region = head.model.region;
  const SE3 T_shoe_base = scan.scene->T_base_shoe.inverse(Eigen::Isometry);
  const auto T_shoe_cam = [&](double time_s) -> SE3 {
    return T_shoe_base * scan.cell.arm.T_base_flange(scan.joints.at(time_s).q_link_rad, false) *
           head.model.T_flange_cam;
  };
  const double half_s = 0.5e-9 * static_cast<double>(head.model.exposure->count());
  sim::StripeRenderer renderer(scan.scene->scene, head);
  sim::Random noise = sim::Random{scan.cell.seed}.fork(15);
  Pictures pictures;
  for (const double time_s : frame_times_s(scan)) {
    sim::Shot shot{.T_scene_cam = T_shoe_cam(time_s), .region = region, .noise_seed = noise.next()};
    sim::disturb(shot, sim::common_disturbances(), T_shoe_cam(time_s - half_s), T_shoe_cam(time_s + half_s),
                 time_s);
    pictures.emplace_back(static_cast<std::size_t>(region.width_px) *
                          static_cast<std::size_t>(region.height_px));
    renderer.render(shot, pictures.back(), nullptr);
  }
  return pictures;
}

Result<HostScan> look(const TipScan& scan, const Pictures& pictures, const Variant& variant) {
  constexpr double k_poses_ahead_s = 0.1;  // beyond what the smoothing reaches
  BITELINE_ASSIGN(const uncertainty::KnownHead head, calibrated_head(scan.cell, variant));
  BITELINE_ASSIGN(pipeline::ProfilePipeline pipeline, pipeline::ProfilePipeline::create({}, head.model));
  const geometry::Region& region = head.model.region;
  const auto out = std::make_unique<profile::ProfileBuffer>();
  ToldPoses poses{scan, variant};
  intake::CloudBuilder builder{head.model};
  intake::LiveLine line{{}};
  const std::vector<double> times_s = frame_times_s(scan);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (!pipeline.rt_process({.pixels = pictures[i],
                              .width_px = region.width_px,
                              .height_px = region.height_px,
                              .stride_bytes = static_cast<std::size_t>(region.width_px),
                              .sequence = i,
                              .exposure_mid = instant(times_s[i])},
                             *out))
      continue;
    poses.push_until(times_s[i] + k_poses_ahead_s);
    pipeline.rt_stamp(*out, poses.history());
    const profile::Profile profile{.header = out->header, .points = {out->view().begin(), out->view().end()}};
    const std::span<const Eigen::Vector3f> points = builder.add(profile);
    line.add_profile(profile.header.sequence, points, intake::pose_of(profile.header),
                     builder.stripe_of_last());
  }
  line.close(std::make_shared<const uncertainty::KnownHead>(head));
  return HostScan{.found = line.wait().extraction, .points_base = builder.cloud().points};
}

}  // namespace biteline::bench
