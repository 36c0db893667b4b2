// SPDX-License-Identifier: MIT
#pragma once
/// \file Inside of ProfilePipeline: shared by its set-up (allocates) and its hot path (fenced), and by nobody else.

#include "firmware/pipeline/profile_pipeline.hpp"

namespace biteline::pipeline {

struct ProfilePipeline::State {
  Config config;
  geometry::Region region;
  Eigen::Isometry3f T_flange_cam;
  Eigen::Vector3f measuring_flange;  ///< direction in which a row error moves a point, at the region's centre
  stripe::PeakExtractor extractor;
  stripe::PeakSelector selector;
  stripe::LineAverage line_average;
  TriangulationTable table;
  stripe::Peaks peaks;
  stripe::Selection selection;
  std::array<stripe::LinePoint, stripe::k_max_columns> line;
  std::array<stripe::LinePoint, stripe::k_max_columns> line_work;
  std::uint64_t next_sequence{0};
};

}  // namespace biteline::pipeline
