// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/surface_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <numbers>

namespace biteline::sim {

namespace {

int steps_for(double length_mm, double step_mm) {
  return std::max(1, static_cast<int>(std::ceil(length_mm / step_mm)));
}

/// The same number of rows in every column, so that columns join into quadrangles.
struct RowPlan {
  int below, fine, above;

  RowPlan(const MadeShoe& shoe, const MeshFineness& fineness) {
    const auto& p = shoe.parameters();
    below = steps_for(p.groove.line_height_mm + std::max(p.groove.toe_rise_mm, p.groove.heel_lift_mm) -
                          fineness.fine_band_mm,
                      fineness.coarse_row_mm);
    fine = steps_for(2 * fineness.fine_band_mm, fineness.fine_row_mm);
    above =
        steps_for(p.upper.top_z_mm - p.groove.line_height_mm - fineness.fine_band_mm, fineness.coarse_row_mm);
  }

  [[nodiscard]] int count() const { return below + fine + above + 1; }

  [[nodiscard]] double height_mm(const Section& section, double fine_band_mm, int row) const {
    const double bottom_mm = section.bottom_z_mm();
    const double low_mm = std::max(bottom_mm, section.line_height_mm() - fine_band_mm),
                 high_mm = std::min(section.top_z_mm(), section.line_height_mm() + fine_band_mm);
    if (row < below) return bottom_mm + (low_mm - bottom_mm) * row / below;
    if (row < below + fine) return low_mm + (high_mm - low_mm) * (row - below) / fine;
    return high_mm + (section.top_z_mm() - high_mm) * (row - below - fine) / above;
  }
};

/// The roof runs from the wall's top to the shoe's middle line, rising a little: it only has to stop light.
constexpr int k_roof_rows = 6;
constexpr double k_roof_rise_mm = 6;

Vec3 roof_point(const Vec3& edge, double length_mm, double part) {
  const Vec3 middle{std::clamp(edge.x(), 0.2 * length_mm, 0.8 * length_mm), 0.02 * length_mm,
                    edge.z() + k_roof_rise_mm};
  Vec3 point = edge + part * (middle - edge);
  point.z() = edge.z() + k_roof_rise_mm * std::sin(0.5 * std::numbers::pi * part);
  return point;
}

int columns_round(const MadeShoe& shoe, const MeshFineness& fineness) {
  return steps_for(shoe.perimeter_mm(), fineness.column_mm);
}

struct Columns {
  int first{0};
  int count{0};
  bool closed{true};  ///< the last is joined to the first
};

SurfaceMesh mesh_of_columns(const MadeShoe& shoe, const MeshFineness& fineness, const Columns& columns) {
  const RowPlan rows(shoe, fineness);
  const int column_rows = rows.count() + k_roof_rows;

  SurfaceMesh mesh;
  const auto vertex_count = static_cast<std::size_t>(columns.count) * static_cast<std::size_t>(column_rows);
  mesh.vertices.reserve(vertex_count);
  mesh.looks.reserve(vertex_count);
  mesh.triangles.reserve(2 * vertex_count);
  const auto add = [&](const Vec3& point, const SurfaceLook& look) {
    mesh.vertices.push_back(
        {static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z())});
    mesh.looks.push_back(look);
  };
  for (int column = columns.first; column < columns.first + columns.count; ++column) {
    const Section section = shoe.section(shoe.perimeter_mm() * column / columns_round(shoe, fineness));
    for (int row = 0; row < rows.count(); ++row) {
      const double z_mm = rows.height_mm(section, fineness.fine_band_mm, row);
      add(section.point(z_mm), section.look(z_mm));
    }
    const Vec3 edge = section.point(section.top_z_mm());
    const SurfaceLook look = section.look(section.top_z_mm());
    for (int row = 1; row <= k_roof_rows; ++row) {
      add(roof_point(edge, shoe.outline().length_mm(), static_cast<double>(row) / k_roof_rows), look);
    }
  }

  for (int column = 0; column + (columns.closed ? 0 : 1) < columns.count; ++column) {
    const auto here = static_cast<std::uint32_t>(column * column_rows);
    const auto next = static_cast<std::uint32_t>(((column + 1) % columns.count) * column_rows);
    for (std::uint32_t row = 0; row + 1 < static_cast<std::uint32_t>(column_rows); ++row) {
      mesh.triangles.push_back({here + row, next + row, next + row + 1});
      mesh.triangles.push_back({here + row, next + row + 1, here + row + 1});
    }
  }
  return mesh;
}

}  // namespace

SurfaceMesh mesh_of(const MadeShoe& shoe, const MeshFineness& fineness) {
  return mesh_of_columns(shoe, fineness,
                         {.first = 0, .count = columns_round(shoe, fineness), .closed = true});
}

SurfaceMesh mesh_of_part(const MadeShoe& shoe, const OutlinePart& part, const MeshFineness& fineness) {
  const double column_mm = shoe.perimeter_mm() / columns_round(shoe, fineness);
  const int first = static_cast<int>(std::floor(part.from_s_mm / column_mm)),
            last = static_cast<int>(std::ceil((part.from_s_mm + part.length_mm) / column_mm));
  return mesh_of_columns(shoe, fineness, {.first = first, .count = last - first + 1, .closed = false});
}

Result<void> write_mesh_ply(const std::filesystem::path& file, const SurfaceMesh& mesh,
                            const SE3& T_frame_shoe) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(file.c_str(), "wb"), &std::fclose);
  if (!out) return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  std::fprintf(
      out.get(),
      "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty float x\nproperty float y\n"
      "property float z\nelement face %zu\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  for (const auto& vertex : mesh.vertices) {
    const Eigen::Vector3f moved = (T_frame_shoe * Vec3(vertex[0], vertex[1], vertex[2])).cast<float>();
    std::fwrite(moved.data(), sizeof(float), 3, out.get());
  }
  for (const auto& triangle : mesh.triangles) {
    std::array<unsigned char, 13> row{3};
    std::memcpy(row.data() + 1, triangle.data(), 12);
    std::fwrite(row.data(), 1, row.size(), out.get());
  }
  if (std::fflush(out.get()) != 0 || std::ferror(out.get()) != 0)
    return fail(Errc::WriteFailed, "%s", file.c_str());
  return {};
}

}  // namespace biteline::sim
