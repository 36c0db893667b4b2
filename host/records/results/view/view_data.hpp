// SPDX-License-Identifier: MIT
#pragma once
/// \file What the page's viewer shows of a result: view_data.js, files.js and viewer.js in a result folder.
///
/// A browser lets a page from a disk load scripts beside it, and nothing else: so the data are scripts.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "host/bite_line/extraction.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/report/page.hpp"

namespace biteline::results {

/// More points than this are thinned, evenly in the order of the scan; the page says so.
inline constexpr std::size_t k_most_view_points = 200'000;

struct ViewData {
  std::string title;
  std::string summary;
  bool found{false};
  nlohmann::ordered_json report;  ///< report.json's fields: figures, refusal, candidates, weak stretches
  const cloud::PointCloud* cloud{nullptr};
  const cloud::ClosedLine* line{nullptr};  ///< base, mm; none when refused
  /// Of a refused scan: what could have been the line, with what its places lack.
  std::span<const bite_line::Candidate> candidates{};
  std::optional<SE3> T_base_shoe;  ///< x heel to toe, y left, z up
  std::vector<Vec3> path_mm;       ///< the tool tip's way, in the frame of line and cloud, when planned
};

/// view_data.js (`window.biteline_view = {...}`), and viewer.js where the page was built; beside and renamed.
[[nodiscard]] Result<void> write_view(const std::filesystem::path& folder, const ViewData& data);

/// files.js (`window.biteline_files = [...]`): what of a result stands in `folder` now, with words.  Written
/// again when a path or a track is added.
[[nodiscard]] Result<void> write_file_list(const std::filesystem::path& folder);

/// The viewer's place on a page, its scripts, and links to the files that need no script.
void add_viewer(report::Page& page, const std::filesystem::path& folder);

/// Where the page's parts were installed: share/biteline/web beside the program's bin; none when not built.
[[nodiscard]] std::optional<std::filesystem::path> page_folder();

}  // namespace biteline::results
