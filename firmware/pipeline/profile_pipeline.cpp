// SPDX-License-Identifier: MIT
#include "firmware/pipeline/profile_pipeline.hpp"

#include "firmware/pipeline/profile_pipeline_state.hpp"

namespace biteline::pipeline {

namespace {

/// A peak's row says how far along the laser's light a point lies: the way it moves when the row changes.
Eigen::Vector3f measuring_direction_flange(const geometry::SensorModel& sensor) {
  const geometry::Region& region = sensor.region;
  const Vec2 centre_px{region.offset_u_px + 0.5 * region.width_px, region.offset_v_px + 0.5 * region.height_px};
  const Vec3 step_cam = geometry::triangulate(sensor.camera, sensor.laser_plane, centre_px + Vec2{0, 0.5}) -
                        geometry::triangulate(sensor.camera, sensor.laser_plane, centre_px - Vec2{0, 0.5});
  return (sensor.T_flange_cam.linear() * step_cam.normalized()).cast<float>();
}

}  // namespace

ProfilePipeline::ProfilePipeline(std::unique_ptr<State> state) : state_{std::move(state)} {}
ProfilePipeline::ProfilePipeline(ProfilePipeline&&) noexcept = default;
ProfilePipeline& ProfilePipeline::operator=(ProfilePipeline&&) noexcept = default;
ProfilePipeline::~ProfilePipeline() = default;

Result<ProfilePipeline> ProfilePipeline::create(const Config& config, const geometry::SensorModel& sensor) {
  BITELINE_ASSIGN(auto extractor,
                  stripe::PeakExtractor::create(config.peaks, sensor.region.width_px, sensor.region.height_px));
  BITELINE_ASSIGN(auto table, TriangulationTable::create(sensor));
  return ProfilePipeline{std::unique_ptr<State>(new State{.config = config,
                                                          .region = sensor.region,
                                                          .T_flange_cam = sensor.T_flange_cam.cast<float>(),
                                                          .measuring_flange = measuring_direction_flange(sensor),
                                                          .extractor = std::move(extractor),
                                                          .selector = stripe::PeakSelector{config.selector},
                                                          .line_average = stripe::LineAverage{config.line_average},
                                                          .table = std::move(table),
                                                          .peaks = {},
                                                          .selection = {},
                                                          .line = {},
                                                          .line_work = {},
                                                          .next_sequence = 0})};
}

}  // namespace biteline::pipeline
