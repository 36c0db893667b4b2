// SPDX-License-Identifier: MIT
#include "host/transfer/sample_folder.hpp"

#include <tbb/parallel_invoke.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/system/file.hpp"
#include "host/cloud/flagged.hpp"
#include "host/cloud/ply.hpp"

namespace biteline::transfer {

namespace {

/// What the folder's report says of its line; empty: it has none, as a model's.
std::string status_of(const std::filesystem::path& folder) {
  const Result<std::string> text = read_regular_file(folder / "report.json", k_most_settings_bytes);
  const nlohmann::json json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json{};
  const auto status = json.is_object() ? json.find("status") : json.end();
  return json.is_object() && status != json.end() && status->is_string() ? status->get<std::string>()
                                                                         : std::string{};
}

}  // namespace

Result<SampleFiles> read_sample(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    return fail(Errc::FileNotFound, "%s: expected the folder of a finished sample", folder.c_str());
  }
  if (std::filesystem::exists(folder / "report.json") && !std::filesystem::exists(folder / k_line_file)) {
    return fail(Errc::FileNotFound, "%s: no %s: this scan has no line, so it is no sample", folder.c_str(),
                k_line_file);
  }
  // A mend that came to nothing leaves its line there.
  if (status_of(folder) == "refused") {
    return fail(Errc::Refused, "%s: this scan was refused, so it is no sample; see its report.json",
                folder.c_str());
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
