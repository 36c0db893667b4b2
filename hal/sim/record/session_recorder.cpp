// SPDX-License-Identifier: MIT
#include "hal/sim/record/session_recorder.hpp"

#include <algorithm>
#include <cmath>

#include "common/config/sensor_yaml.hpp"
#include "common/image/grey_image.hpp"
#include "common/session/session.hpp"
#include "hal/sim/record/files.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

/// Poses begin before the first frame and end after the last, so that each frame lies between two.
constexpr Nanoseconds k_pose_margin{20'000'000};

Nanoseconds seconds(double s) {
  return Nanoseconds{std::llround(s * 1e9)};
}

HeadWay even_way(const MadeScene& scene) {
  const auto T_base_flange_at = [&scene](double time_s) -> SE3 {
    const double way_mm = time_s * scene.path.settings().speed_mm_s;
    return scene.T_base_shoe * scene.path.T_shoe_cam_at(way_mm) *
           scene.head.model.T_flange_cam.inverse(Eigen::Isometry);
  };
  return {.duration_s = scene.path.duration_s(),
          .T_base_flange_at = T_base_flange_at,
          .T_base_flange_told_at = T_base_flange_at};
}

/// What of the path is recorded, by frame numbers of the whole scan.
struct FrameRange {
  int first, end;
};

FrameRange frames_of(const MadeScene& scene, const HeadWay& way, const RecordSettings& settings) {
  const auto all = static_cast<int>(std::ceil(way.duration_s * scene.settings.rate_hz));
  if (!settings.part) return {.first = 0, .end = all};
  const auto first_from = [&](double s_mm) {
    const double way_mm = s_mm - scene.path.s_at_mm(0);
    const double frame = way_mm / scene.path.settings().speed_mm_s * scene.settings.rate_hz;
    return std::clamp(static_cast<int>(std::ceil(frame)), 0, all);
  };
  return {.first = first_from(settings.part->from_s_mm),
          .end = first_from(settings.part->from_s_mm + settings.part->length_mm)};
}

/// The surface that the stripes may lie on: they are not quite upright sections.
OutlinePart surface_part(const OutlinePart& part) {
  constexpr double k_margin_mm = 3;
  return {.from_s_mm = part.from_s_mm - k_margin_mm, .length_mm = part.length_mm + 2 * k_margin_mm};
}

std::vector<session::StampedPose> made_poses(const MadeScene& scene, const HeadWay& way,
                                             const RecordSettings& settings, const FrameRange& frames) {
  Random random = Random(settings.noise_seed).fork(1);
  std::vector<session::StampedPose> poses;
  const double margin_s = static_cast<double>(k_pose_margin.count()) * 1e-9;
  const double begin_s = frames.first / scene.settings.rate_hz - margin_s;
  const double last_s = settings.part ? (frames.end - 1) / scene.settings.rate_hz : way.duration_s;
  const auto count = static_cast<int>((last_s + margin_s - begin_s) * settings.pose_rate_hz);
  for (int i = 0; i <= count; ++i) {
    const double time_s = i / settings.pose_rate_hz + begin_s;
    Twist noise;
    for (int k = 0; k < 3; ++k) {
      noise[k] = settings.pose_noise_mm * random.gaussian();
      noise[k + 3] = settings.pose_noise_rad * random.gaussian();
    }
    poses.push_back(
        {.stamp = RobotClock::time_point{settings.start + seconds(time_s) + settings.pose_clock_offset},
         .T_base_flange = way.T_base_flange_told_at(time_s) * geometry::exp_se3(noise)});
  }
  return poses;
}

/// Files keep the names of the true instants.
void stamp_by_arrival(std::vector<session::FrameEntry>& frames, const ArrivalStamps& arrival,
                      std::uint64_t seed) {
  std::vector<SensorClock::time_point> mids;
  for (const session::FrameEntry& frame : frames) mids.push_back(frame.exposure_mid);
  const auto stamps = arrival_stamps(mids, arrival, seed);
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i].exposure_mid = stamps[i];
}

}  // namespace

Result<void> record_session(const std::filesystem::path& folder, const MadeScene& scene,
                            const RecordSettings& settings, const std::function<void(double)>& progress) {
  BITELINE_TRY(make_folder(folder / "cam0" / "data"));
  BITELINE_TRY(make_folder(folder / "pose0"));

  geometry::SensorModel told = scene.head.model;
  told.pose_clock_offset = settings.tell_clock_offset ? settings.pose_clock_offset : Nanoseconds{0};
  BITELINE_TRY(
      write_file(folder / "cam0" / "sensor.yaml",
                 config::sensor_yaml_text(
                     told, "made head " + std::to_string(scene.settings.head_seed) + ", simulated")));

  const auto& region = scene.head.model.region;
  image::GreyImage picture{.width_px = region.width_px, .height_px = region.height_px, .pixels = {}};
  picture.pixels.resize(static_cast<std::size_t>(region.width_px) *
                        static_cast<std::size_t>(region.height_px));
  StripeRenderer renderer(scene.scene, scene.head);
  const SE3 T_shoe_base = scene.T_base_shoe.inverse(Eigen::Isometry);
  std::vector<session::FrameEntry> frames;
  const HeadWay way = settings.way ? *settings.way : even_way(scene);
  const FrameRange range = frames_of(scene, way, settings);
  if (range.first >= range.end)
    return fail(Errc::InvalidArgument,
                "no frame of the scan lies in the part asked for: the way round is %.0f mm",
                scene.shoe.perimeter_mm());
  Random noise = Random(settings.noise_seed).fork(2);
  for (int i = range.first; i < range.end; ++i) {
    const double time_s = i / scene.settings.rate_hz;
    const auto T_scene_cam_at = [&](double at_s) -> SE3 {
      if (settings.way) return T_shoe_base * way.T_base_flange_at(at_s) * scene.head.model.T_flange_cam;
      return scene.path.T_shoe_cam_at(at_s * scene.path.settings().speed_mm_s);
    };
    const double half_s = 0.5e-9 * static_cast<double>(scene.head.model.exposure->count());
    Shot shot{.T_scene_cam = T_scene_cam_at(time_s), .region = region, .noise_seed = noise.next()};
    disturb(shot, settings.disturbances, T_scene_cam_at(time_s - half_s), T_scene_cam_at(time_s + half_s),
            time_s);
    renderer.render(shot, picture.pixels, nullptr);
    const Nanoseconds stamp = settings.start + seconds(time_s);
    frames.push_back({.exposure_mid = SensorClock::time_point{stamp},
                      .file = folder / "cam0" / "data" / (std::to_string(stamp.count()) + ".png")});
    BITELINE_TRY(image::write_png(frames.back().file, picture));
    if (progress) progress(static_cast<double>(i + 1 - range.first) / (range.end - range.first));
  }
  if (settings.arrival) stamp_by_arrival(frames, *settings.arrival, settings.noise_seed);
  BITELINE_TRY(session::write_frame_table(folder / "cam0" / "data.csv", frames));
  BITELINE_TRY(
      session::write_pose_table(folder / "pose0" / "data.csv", made_poses(scene, way, settings, range)));
  if (!settings.part) return write_truth(folder / "truth", scene);
  return write_truth(folder / "truth", scene, surface_part(*settings.part));
}

}  // namespace biteline::sim
