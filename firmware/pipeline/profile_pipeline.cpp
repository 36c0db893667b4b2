// SPDX-License-Identifier: MIT
#include "firmware/pipeline/profile_pipeline.hpp"

#include "firmware/pipeline/profile_pipeline_state.hpp"

namespace biteline::pipeline {
namespace {

/// A peak's row says how far along the laser's light a point lies: the way it moves when the row changes.
Eigen::Vector3f measuring_direction_flange(const geometry::SensorModel& sensor) {
  const geometry::Region& region = sensor.region;
  const Vec2 centre_px{region.offset_u_px + 0.5 * region.width_px,
                       region.offset_v_px + 0.5 * region.height_px};
  const Vec3 step_cam = geometry::triangulate(sensor.camera, sensor.laser_plane, centre_px + Vec2{0, 0.5}) -
                        geometry::triangulate(sensor.camera, sensor.laser_plane, centre_px - Vec2{0, 0.5});
  return (sensor.T_flange_cam.linear() * step_cam.normalized()).cast<float>();
}

std::size_t pixel_count(const geometry::Region& region) {
  return static_cast<std::size_t>(region.width_px) * static_cast<std::size_t>(region.height_px);
}

}  // namespace

ProfilePipeline::State::State(const Config& given, const geometry::SensorModel& sensor,
                              stripe::PeakExtractor made_extractor, TriangulationTable made_table)
    : config{given},
      region{sensor.region},
      T_flange_cam{sensor.T_flange_cam.cast<float>()},
      T_flange_cam_exact{sensor.T_flange_cam},
      measuring_flange{measuring_direction_flange(sensor)},
      extractor{std::move(made_extractor)},
      line_average{given.line_average},
      table{std::move(made_table)},
      first{given.selector},
      second{given.selector},
      ambient(pixel_count(sensor.region)),
      difference(pixel_count(sensor.region)) {}

ProfilePipeline::ProfilePipeline(std::unique_ptr<State> state) : state_{std::move(state)} {}
ProfilePipeline::ProfilePipeline(ProfilePipeline&&) noexcept = default;
ProfilePipeline& ProfilePipeline::operator=(ProfilePipeline&&) noexcept = default;
ProfilePipeline::~ProfilePipeline() = default;

Result<ProfilePipeline> ProfilePipeline::create(const Config& config, const geometry::SensorModel& sensor) {
  BITELINE_ASSIGN(auto extractor, stripe::PeakExtractor::create(config.peaks, sensor.region.width_px,
                                                                sensor.region.height_px));
  BITELINE_ASSIGN(auto table, TriangulationTable::create(sensor));
  return ProfilePipeline{std::make_unique<State>(config, sensor, std::move(extractor), std::move(table))};
}

Result<ProfilePipeline::PeakChange> ProfilePipeline::prepare_peaks(const stripe::PeakConfig& peaks,
                                                                   stripe::PeakChoice choice) const {
  BITELINE_ASSIGN(auto extractor,
                  stripe::PeakExtractor::create(peaks, state_->region.width_px, state_->region.height_px));
  return PeakChange{.extractor = std::move(extractor), .choice = choice};
}

}  // namespace biteline::pipeline
