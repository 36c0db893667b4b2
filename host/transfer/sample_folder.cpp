// SPDX-License-Identifier: MIT
#include "host/transfer/sample_folder.hpp"

#include <tbb/parallel_invoke.h>

#include <optional>

#include "host/cloud/flagged.hpp"
#include "host/cloud/ply.hpp"

namespace biteline::transfer {

Result<SampleFiles> read_sample(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    return fail(Errc::FileNotFound, "%s: expected the folder of a finished sample", folder.c_str());
  }
  if (std::filesystem::exists(folder / "report.json") && !std::filesystem::exists(folder / k_line_file)) {
    return fail(Errc::FileNotFound, "%s: no %s: this scan has no line, so it is no sample", folder.c_str(),
                k_line_file);
  }
  std::optional<Result<cloud::PointCloud>> cloud;
  std::optional<Result<cloud::ClosedLine>> line;
  tbb::parallel_invoke([&] { cloud = cloud::read_cloud(folder / k_cloud_file); },
                       [&] { line = cloud::read_line(folder / k_line_file); });
  BITELINE_TRY(*line);
  if (cloud::flagged_share(**line) > cloud::k_most_flagged_share) {
    return fail(Errc::Refused,
                "%s: a person must settle its line first (biteline line edit), and then it is a sample",
                folder.c_str());
  }
  BITELINE_TRY(*cloud);
  return SampleFiles{.cloud = std::move(**cloud), .line = std::move(**line)};
}

}  // namespace biteline::transfer
