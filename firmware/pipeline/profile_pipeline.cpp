// SPDX-License-Identifier: MIT
#include "firmware/pipeline/profile_pipeline.hpp"

#include "firmware/pipeline/profile_pipeline_state.hpp"

namespace biteline::pipeline {

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
