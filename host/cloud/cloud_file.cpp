// SPDX-License-Identifier: MIT
#include "host/cloud/cloud_file.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "common/core/fixed_text.hpp"
#include "common/core/numbers.hpp"
#include "host/cloud/mesh_file.hpp"
#include "host/cloud/pcd.hpp"
#include "host/cloud/ply.hpp"
#include "host/cloud/sample_surface.hpp"
#include "host/cloud/text_cloud.hpp"

namespace biteline::cloud {
namespace {

namespace fs = std::filesystem;

/// As dense as a scan: profiles every 0.5 mm, columns closer.
constexpr double k_mesh_spacing_mm = 0.35;

/// No sole is shorter than 90 mm; half of one may be in view.
constexpr double k_least_shoe_mm = 45;
/// A shoe on a table in metres, and everything larger that is still too small in mm, in inches.
constexpr double k_most_metres = 2;

std::string ending(const fs::path& file) {
  std::string text = file.extension().string();
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool is_one_of(const std::string& text, std::initializer_list<const char*> names) {
  return std::ranges::any_of(names, [&](const char* name) { return text == name; });
}

Result<CloudFile> from_mesh(Result<TriangleMesh> mesh, double mm_per_unit) {
  if (!mesh) return tl::unexpected<Error>(mesh.error());
  CloudFile read;
  if (mesh->faces.empty()) {
    read.cloud.points = std::move(mesh->vertices);
    return read;
  }
  BITELINE_ASSIGN(read.cloud.points, sample_surface(*mesh, k_mesh_spacing_mm / mm_per_unit));
  return read;
}

Result<CloudFile> read_by_ending(const fs::path& file, double mm_per_unit) {
  CloudFile read;
  const std::string type = ending(file);
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    return fail(Errc::BadFormat,
                "%s: a folder, and a cloud's file expected; `biteline replay` takes a session's folder",
                file.c_str());
  }
  if (type == ".ply") {
    BITELINE_ASSIGN(read.cloud, read_cloud(file, &read.dropped));
    return read;
  }
  if (is_one_of(type, {".xyz", ".txt", ".asc", ".csv", ".pts"})) {
    BITELINE_ASSIGN(read.cloud.points, read_text_cloud(file, read.dropped));
    return read;
  }
  if (type == ".pcd") {
    BITELINE_ASSIGN(read.cloud.points, read_pcd(file, read.dropped));
    return read;
  }
  if (type == ".stl") return from_mesh(read_stl(file), mm_per_unit);
  if (type == ".obj") return from_mesh(read_obj(file), mm_per_unit);
  return fail(Errc::BadFormat, "%s: a cloud expected: .ply .xyz .txt .asc .csv .pts .pcd .stl .obj",
              file.c_str());
}

/// Length of the longest side of the box that holds 98 % of the points along each axis.
double extent(const PointCloud& cloud) {
  constexpr std::size_t k_most_looked_at = 20'000;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / k_most_looked_at);
  double longest = 0;
  std::vector<float> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < cloud.size(); i += step) values.push_back(cloud.points[i][axis]);
    std::ranges::sort(values);
    const std::size_t cut = values.size() / 100;
    longest = std::max(longest, static_cast<double>(values[values.size() - 1 - cut] - values[cut]));
  }
  return longest;
}

}  // namespace

double mm_per(Unit unit) {
  switch (unit) {
    case Unit::Millimetre:
      return 1;
    case Unit::Metre:
      return 1000;
    case Unit::Inch:
      return 25.4;
  }
  return 1;
}

Result<CloudFile> read_cloud_file(const fs::path& file, std::optional<Unit> unit) {
  const double scale = mm_per(unit.value_or(Unit::Millimetre));
  BITELINE_ASSIGN(CloudFile read, read_by_ending(file, scale));
  if (read.cloud.points.empty())
    return fail(Errc::BadValue, "%s: no point with finite numbers", file.c_str());
  if (scale == 1) return read;
  for (std::size_t i = 0; i < read.cloud.size(); ++i) {
    read.cloud.points[i] *= static_cast<float>(scale);
    if (!is_plausible_place(read.cloud.points[i]))
      return fail(Errc::BadValue, "%s, point %zu: beyond 100 m in the unit given", file.c_str(), i + 1);
  }
  return read;
}

std::span<const report::RefusalRow<UnitRefused>> refusal_table(UnitRefused) {
  using Row = report::RefusalRow<UnitRefused>;
  static constexpr std::array k_rows{
      Row{UnitRefused::OtherUnit, "other_unit", "say the cloud's unit: --unit mm, m or in"}};
  return k_rows;
}

std::optional<report::Refusal<UnitRefused>> unit_refusal(const PointCloud& cloud, std::optional<Unit> given) {
  if (given || cloud.size() == 0) return std::nullopt;
  const double size = extent(cloud);
  if (!(size < k_least_shoe_mm)) return std::nullopt;
  const bool metres = size <= k_most_metres;
  return report::Refusal<UnitRefused>{
      .code = UnitRefused::OtherUnit,
      .reason = std::string(FixedText<160>::format("the cloud is %.3g mm long, too small for a shoe; "
                                                   "in %s it would be %.0f mm: give --unit %s",
                                                   size, metres ? "metres" : "inches",
                                                   size * mm_per(metres ? Unit::Metre : Unit::Inch),
                                                   metres ? "m" : "in")
                                .view())};
}

}  // namespace biteline::cloud
