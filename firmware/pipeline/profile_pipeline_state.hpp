// SPDX-License-Identifier: MIT
#pragma once
/// \file Inside of ProfilePipeline: shared by its set-up (allocates) and its hot path (fenced), and by nobody
/// else.

#include <array>
#include <optional>
#include <vector>

#include "firmware/pipeline/profile_pipeline.hpp"
#include "hal/api/line_camera.hpp"

namespace biteline::pipeline {

/// One exposure's stripe: what was seen, which peaks were chosen, and the chosen ones as an averaged line.
struct ExposedStripe {
  explicit ExposedStripe(const stripe::SelectorConfig& config) : selector{config} {}

  stripe::PeakSelector selector;
  stripe::Peaks peaks;
  stripe::Selection selection;
  std::array<stripe::LinePoint, stripe::k_max_columns> line;
  /// What of the frame the profile's header needs.
  SensorClock::time_point exposure_mid;
  std::uint64_t frame_sequence{0};
  std::uint32_t frame_flags{0};
};

struct ProfilePipeline::State {
  State(const Config& given, const geometry::SensorModel& sensor, stripe::PeakExtractor made_extractor,
        TriangulationTable made_table);

  Config config;
  geometry::Region region;
  Eigen::Isometry3f T_flange_cam;
  SE3 T_flange_cam_exact;
  Eigen::Vector3f measuring_flange;  ///< direction in which a row error moves a point, at the region's centre
  stripe::PeakExtractor extractor;
  stripe::LineAverage line_average;
  TriangulationTable table;
  ExposedStripe first;   ///< the only one without bracketing
  ExposedStripe second;  ///< the longer exposure
  bool first_waits{false};
  std::array<stripe::LinePoint, stripe::k_max_columns> line_work;
  std::vector<std::uint8_t> ambient;     ///< the last laser-off frame, without padding
  std::vector<std::uint8_t> difference;  ///< lit frame less ambient
  std::optional<SensorClock::time_point> ambient_mid;
  hal::RowRange ambient_rows;
  std::uint64_t next_sequence{0};
};

}  // namespace biteline::pipeline
