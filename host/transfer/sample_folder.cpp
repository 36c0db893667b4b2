// SPDX-License-Identifier: MIT
#include "host/transfer/sample_folder.hpp"

#include <tbb/parallel_invoke.h>

#include <optional>

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
  BITELINE_TRY(*cloud);
  return SampleFiles{.cloud = std::move(**cloud), .line = std::move(**line)};
}

}  // namespace biteline::transfer
