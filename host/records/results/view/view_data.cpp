// SPDX-License-Identifier: MIT
#include "host/records/results/view/view_data.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "common/core/base64.hpp"
#include "host/records/results/view/weak_stretches.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::results {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "view_data.js is little endian");

/// A file of a result folder that a person may want.
struct NamedFile {
  const char* file;
  const char* words;
};
constexpr std::array k_named_files{
    NamedFile{"line.csv", "the line (CSV, mm)"},
    NamedFile{"cloud.ply", "the point cloud (PLY, mm)"},
    NamedFile{"report.json", "all figures (JSON)"},
    NamedFile{"path/path.csv", "the planned path (CSV)"},
    NamedFile{"path/path.script", "the robot's program (URScript)"},
    NamedFile{"path/index.html", "the path's own page"},
    NamedFile{"path/tracking.html", "the arm along the path, in 3-D"},
    NamedFile{"path/report.json", "the path's checks (JSON)"},
    NamedFile{"path.csv", "the planned path (CSV)"},
    NamedFile{"path.script", "the robot's program (URScript)"},
    NamedFile{"tracking.html", "the arm along the path, in 3-D"},
    NamedFile{"coverage.ply", "what the tool covers (PLY)"},
    NamedFile{"coverage.png", "what the tool covers"},
    NamedFile{"gate.json", "the decision before the arm moved (JSON)"},
    NamedFile{"followed.json", "how the arm followed (JSON)"},
    NamedFile{"track.csv", "the arm's recorded way (CSV)"},
};

double rounded(double value, double per_unit) {
  return std::round(value * per_unit) / per_unit;
}

ordered_json xyz(const Vec3& p, double per_unit) {
  return {rounded(p.x(), per_unit), rounded(p.y(), per_unit), rounded(p.z(), per_unit)};
}

/// 16 bits of each axis over the largest extent: 0.005 mm in a shoe.
ordered_json as_json(const cloud::PointCloud& cloud) {
  const std::size_t every = 1 + (cloud.size() - 1) / k_most_view_points;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : cloud.points) box.extend(p);
  const double step_mm = std::max(1e-6, static_cast<double>(box.sizes().maxCoeff()) / 65535);
  std::vector<std::uint16_t> places;
  for (std::size_t i = 0; i < cloud.size(); i += every) {
    for (int axis = 0; axis < 3; ++axis) {
      const double offset_mm =
          static_cast<double>(cloud.points[i][axis]) - static_cast<double>(box.min()[axis]);
      places.push_back(static_cast<std::uint16_t>(std::lround(offset_mm / step_mm)));
    }
  }
  return {{"of", cloud.size()},
          {"every", every},
          {"origin_mm", {box.min().x(), box.min().y(), box.min().z()}},
          {"step_mm", step_mm},
          {"xyz_u16", to_base64({reinterpret_cast<const char*>(places.data()), 2 * places.size()})}};
}

const char* source_name(cloud::PointSource source) {
  switch (source) {
    case cloud::PointSource::Seen:
      return "seen";
    case cloud::PointSource::Bridged:
      return "bridged";
    case cloud::PointSource::Carried:
      return "carried";
    case cloud::PointSource::Mended:
      return "mended";
  }
  return "seen";
}

ordered_json as_json(const cloud::ClosedLine& line) {
  ordered_json out{{"xyz_mm", ordered_json::array()},
                   {"normal", ordered_json::array()},
                   {"confidence", ordered_json::array()},
                   {"u95_mm", ordered_json::array()},
                   {"source", ordered_json::array()}};
  for (const cloud::LinePoint& point : line.points) {
    out["xyz_mm"].push_back(xyz(point.position, 1e3));
    out["normal"].push_back(xyz(point.normal, 1e3));
    out["confidence"].push_back(rounded(point.confidence, 1e3));
    out["u95_mm"].push_back(point.u95_mm ? ordered_json(rounded(*point.u95_mm, 1e3)) : ordered_json());
    out["source"].push_back(source_name(point.source));
  }
  return out;
}

/// At most so many places of each: a candidate is a course, and no line to work.
constexpr std::size_t k_most_candidate_points = 600;

ordered_json as_json(std::span<const bite_line::Candidate> candidates) {
  ordered_json list = ordered_json::array();
  for (const bite_line::Candidate& candidate : candidates) {
    const std::size_t every = 1 + candidate.points.size() / k_most_candidate_points;
    ordered_json one{{"points", ordered_json::array()}};
    if (!candidate.lacks.empty()) one["lacks"] = ordered_json::array();
    for (std::size_t i = 0; i < candidate.points.size(); i += every) {
      one["points"].push_back(xyz(candidate.points[i], 100));
      if (!candidate.lacks.empty()) one["lacks"].push_back(candidate.lacks[i]);
    }
    list.push_back(std::move(one));
  }
  return list;
}

const char* side_name(InnerSide side) {
  return side == InnerSide::Left ? "left" : side == InnerSide::Right ? "right" : "unknown";
}

Result<void> write_script(const fs::path& file, const char* name, const ordered_json& value) {
  // "</" would end the script early if somebody pastes it into a page.
  std::string text;
  for (const char c : report::to_text(value, -1)) {
    if (c == '/' && text.ends_with('<')) text += '\\';
    text += c;
  }
  return report::write_file_atomically(file, "window." + std::string(name) + " = " + text + ";\n");
}

/// Copies viewer.js beside the result, so that the folder can be given away.
Result<void> copy_viewer(const fs::path& folder) {
  const std::optional<fs::path> page = page_folder();
  if (!page) return {};
  std::error_code error;
  fs::copy_file(*page / "viewer.js", folder / "viewer.js.new", fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(folder / "viewer.js.new", folder / "viewer.js", error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", (folder / "viewer.js").c_str());
  return {};
}

}  // namespace

std::optional<fs::path> page_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return std::nullopt;
  fs::path folder = program.parent_path().parent_path() / "share/biteline/web";
  if (!fs::is_regular_file(folder / "viewer.js", error)) return std::nullopt;
  return folder;
}

Result<void> write_view(const fs::path& folder, const ViewData& data) {
  ordered_json view{{"schema_version", 1},
                    {"title", data.title},
                    {"summary", data.summary},
                    {"found", data.found},
                    {"report", data.report}};
  if (data.T_base_shoe) {
    view["T_base_shoe"] = ordered_json::array();
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column)
        view["T_base_shoe"].push_back(data.T_base_shoe->matrix()(row, column));
    }
  }
  if (data.cloud && data.cloud->size() > 0) view["cloud"] = as_json(*data.cloud);
  if (data.line && !data.line->points.empty()) {
    view["line"] = as_json(*data.line);
    if (data.T_base_shoe) view["inner_side"] = side_name(inner_side(*data.line, *data.T_base_shoe));
  }
  if (!data.candidates.empty()) view["candidates"] = as_json(data.candidates);
  if (!data.path_mm.empty()) {
    view["path_mm"] = ordered_json::array();
    for (const Vec3& p : data.path_mm) view["path_mm"].push_back(xyz(p, 100));
  }
  BITELINE_TRY(write_script(folder / "view_data.js", "biteline_view", view));
  BITELINE_TRY(write_file_list(folder));
  return copy_viewer(folder);
}

Result<void> write_file_list(const fs::path& folder) {
  ordered_json list = ordered_json::array();
  for (const auto& [file, words] : k_named_files) {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(folder / file, error);
    if (!error) list.push_back({{"file", file}, {"words", words}, {"bytes", bytes}});
  }
  return write_script(folder / "files.js", "biteline_files", list);
}

void add_viewer(report::Page& page, const fs::path& folder) {
  page.heading("In 3-D");
  page.place(
      "viewer",
      "The viewer needs JavaScript and the parts of the page (host/web); the pictures below need neither.");
  page.heading("Files");
  for (const auto& [file, words] : k_named_files) {
    std::error_code error;
    if (fs::is_regular_file(folder / file, error)) page.link(file, words);
  }
  page.place("more_files", "");
  for (const char* script : {"files.js", "view_data.js", "viewer.js"}) {
    std::error_code error;
    if (fs::is_regular_file(folder / script, error)) page.script(script);
  }
}

}  // namespace biteline::results
