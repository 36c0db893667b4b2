// SPDX-License-Identifier: MIT
#pragma once
/// \file A scan's line weighed against the mended line of its model.

#include <filesystem>
#include <string>

#include "host/apps/biteline-host/recognise.hpp"
#include "host/apps/biteline-host/scan_pipeline.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/transfer/sample_folder.hpp"

namespace biteline::service {

/// A model whose line a person has mended, and where it lies on the scan, where that is known.
struct MendedModel {
  std::string name;
  const transfer::SampleFiles& sample;
  const OnScan* on_scan{nullptr};  ///< null: it is aligned here
};

/// Of the scan's candidates that pass their gates the one nearest to the model's line is taken, as a new
/// version of the line.  A difference above its U95 is told in report.json (`prior`) and on stdout.  Nothing
/// is done where nobody has mended the model's line, or where the scan has no line.  A model that cannot be
/// aligned with the scan chooses nothing, and that is told.
[[nodiscard]] Result<LineStep> heed_mended_model(const std::filesystem::path& folder, LineStep found,
                                                 const cloud::PointCloud& cloud, const MendedModel& model);

}  // namespace biteline::service
