// SPDX-License-Identifier: MIT
#include "host/cloud/ply.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/numbers.hpp"
#include "common/system/file.hpp"
#include "host/cloud/ply_header.hpp"

namespace biteline::cloud {
namespace {

/// Values of one row, in the order of the element's properties; lists are skipped.
Result<void> read_row(PlyBody& body, const PlyElement& element, std::vector<double>& values) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (!property.is_list) {
      BITELINE_ASSIGN(values[i], body.next(property.type));
      continue;
    }
    BITELINE_ASSIGN(const double count, body.next(property.count_type));
    for (double k = 0; k < count; ++k) BITELINE_TRY(body.next(property.type));
  }
  return body.end_row();
}

Result<void> skip_element(PlyBody& body, const PlyElement& element) {
  // Without properties its rows take no room in the file, however many the header says there are.
  if (element.properties.empty()) return {};
  if (!body.ascii() && !element.has_list()) {
    // Divided, since count * size may overflow in a damaged header.
    const std::size_t row_bytes = element.row_bytes();
    for (std::size_t i = 0; i < element.count; ++i) BITELINE_TRY(body.skip_bytes(row_bytes));
    return {};
  }
  std::vector<double> values(element.properties.size());
  for (std::size_t i = 0; i < element.count; ++i) BITELINE_TRY(read_row(body, element, values));
  return {};
}

/// Where the properties of a cloud stand in a row; -1: not there.
struct CloudColumns {
  int x, y, z, nx, ny, nz, profile, column, sigma_mm, flags, mean_curvature, amplitude, width_px;

  explicit CloudColumns(const PlyElement& vertex)
      : x{vertex.find("x")},
        y{vertex.find("y")},
        z{vertex.find("z")},
        nx{vertex.find("nx")},
        ny{vertex.find("ny")},
        nz{vertex.find("nz")},
        profile{vertex.find("profile")},
        column{vertex.find("column")},
        sigma_mm{vertex.find("sigma_mm")},
        flags{vertex.find("flags")},
        mean_curvature{vertex.find("mean_curvature")},
        amplitude{vertex.find("amplitude")},
        width_px{vertex.find("width_px")} {}

  [[nodiscard]] bool has_normals() const { return nx >= 0 && ny >= 0 && nz >= 0; }
  [[nodiscard]] bool has_order() const { return profile >= 0 && column >= 0; }
};

/// What does not fit a float is unknown.
float float_or(double value, float unknown) {
  return NumberRange{}.holds(value) ? static_cast<float>(value) : unknown;
}

template <class Integer>
Integer clamp_to(double value) {
  if (!(value >= 0)) return 0;  // NaN too
  return value >= static_cast<double>(std::numeric_limits<Integer>::max())
             ? std::numeric_limits<Integer>::max()
             : static_cast<Integer>(value);
}

void append(PointCloud& cloud, const CloudColumns& at, const std::vector<double>& row) {
  const auto value = [&](int index) { return row[static_cast<std::size_t>(index)]; };
  cloud.points.push_back(
      {static_cast<float>(value(at.x)), static_cast<float>(value(at.y)), static_cast<float>(value(at.z))});
  if (at.has_normals()) {
    Eigen::Vector3d normal(value(at.nx), value(at.ny), value(at.nz));
    const double length = normal.norm();
    cloud.normals.push_back(std::isfinite(length) && length > 0.5
                                ? Eigen::Vector3f((normal / length).cast<float>())
                                : Eigen::Vector3f::Zero());
  }
  if (at.has_order()) {
    cloud.profile.push_back(clamp_to<std::uint32_t>(value(at.profile)));
    cloud.column.push_back(clamp_to<std::uint16_t>(value(at.column)));
  }
  if (at.sigma_mm >= 0) cloud.sigma_mm.push_back(float_or(value(at.sigma_mm), 0.F));
  if (at.flags >= 0) cloud.flags.push_back(clamp_to<std::uint16_t>(value(at.flags)));
  if (at.mean_curvature >= 0)
    cloud.mean_per_mm.push_back(float_or(value(at.mean_curvature), std::numeric_limits<float>::quiet_NaN()));
  if (at.amplitude >= 0) cloud.amplitude.push_back(std::max(0.F, float_or(value(at.amplitude), 0.F)));
  if (at.width_px >= 0) cloud.width_px.push_back(std::max(0.F, float_or(value(at.width_px), 0.F)));
}

Result<const PlyElement*> find_vertices(const PlyHeader& header, const std::string& name) {
  if (std::ranges::count(header.elements, "vertex", &PlyElement::name) > 1)
    return fail(Errc::BadFormat, "%s: only one element vertex expected", name.c_str());
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex") continue;
    for (const char* axis : {"x", "y", "z"}) {
      const int index = element.find(axis);
      if (index < 0 || element.properties[static_cast<std::size_t>(index)].is_list) {
        return fail(Errc::BadFormat, "%s, element vertex: property %s expected", name.c_str(), axis);
      }
    }
    if (element.count == 0)
      return fail(Errc::BadFormat, "%s, element vertex: at least one point expected", name.c_str());
    return &element;
  }
  return fail(Errc::BadFormat, "%s: element vertex expected", name.c_str());
}

/// A row of a binary file costs at least one byte: a count beyond that is a damaged header, not a reason to
/// ask for memory.
std::size_t plausible_count(const PlyElement& element, std::size_t file_bytes) {
  return std::min(element.count, file_bytes);
}

}  // namespace

Result<PointCloud> read_cloud(const std::filesystem::path& file, std::size_t* dropped) {
  const std::string name = file.string();
  BITELINE_ASSIGN(const std::string bytes, read_regular_file(file, k_most_cloud_bytes));
  BITELINE_ASSIGN(const PlyHeader header, parse_ply_header(bytes, name));
  BITELINE_ASSIGN(const PlyElement* vertices, find_vertices(header, name));
  PlyBody body{bytes, header, name};
  for (const PlyElement* element = header.elements.data(); element != vertices; ++element)
    BITELINE_TRY(skip_element(body, *element));

  const CloudColumns at{*vertices};
  PointCloud cloud;
  cloud.points.reserve(plausible_count(*vertices, bytes.size()));
  std::vector<double> row(vertices->properties.size());
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < vertices->count; ++i) {
    BITELINE_TRY(read_row(body, *vertices, row));
    const auto near = [&](int index) { return k_plausible_mm.holds(row[static_cast<std::size_t>(index)]); };
    if (near(at.x) && near(at.y) && near(at.z)) {
      append(cloud, at, row);
    } else {
      ++left_out;
    }
  }
  if (cloud.points.empty())
    return fail(Errc::BadValue, "%s: no point with finite numbers below 100 m among %zu", name.c_str(),
                vertices->count);
  if (dropped != nullptr) *dropped = left_out;
  return cloud;
}

Result<TriangleMesh> read_mesh(const std::filesystem::path& file) {
  const std::string name = file.string();
  BITELINE_ASSIGN(const std::string bytes, read_regular_file(file, k_most_cloud_bytes));
  BITELINE_ASSIGN(const PlyHeader header, parse_ply_header(bytes, name));
  BITELINE_TRY(find_vertices(header, name));
  PlyBody body{bytes, header, name};
  TriangleMesh mesh;
  std::vector<double> row;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      const CloudColumns at{element};
      row.assign(element.properties.size(), 0);
      mesh.vertices.reserve(plausible_count(element, bytes.size()));
      for (std::size_t i = 0; i < element.count; ++i) {
        BITELINE_TRY(read_row(body, element, row));
        const Eigen::Vector3d vertex(row[static_cast<std::size_t>(at.x)], row[static_cast<std::size_t>(at.y)],
                                     row[static_cast<std::size_t>(at.z)]);
        if (!is_plausible_place(vertex))
          return fail(Errc::BadValue, "%s, vertex %zu: finite numbers below 100 m expected", name.c_str(), i);
        mesh.vertices.push_back(vertex.cast<float>());
      }
    } else if (element.name == "face") {
      // As in skip_element().
      for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
        for (const PlyProperty& property : element.properties) {
          if (!property.is_list) {
            BITELINE_TRY(body.next(property.type));
            continue;
          }
          BITELINE_ASSIGN(const double count, body.next(property.count_type));
          const bool is_face = property.name == "vertex_indices" || property.name == "vertex_index";
          std::array<std::uint32_t, 3> face{};
          for (double k = 0; k < count; ++k) {
            BITELINE_ASSIGN(const double index, body.next(property.type));
            if (!is_face) continue;
            if (!(index >= 0 && index < static_cast<double>(mesh.vertices.size()))) {
              return fail(Errc::BadValue, "%s, face %zu: a vertex number below %zu expected", name.c_str(), i,
                          mesh.vertices.size());
            }
            const auto vertex = static_cast<std::uint32_t>(index);
            if (k == 0) face[0] = vertex;
            if (k >= 2) {
              face[1] = face[2];
              face[2] = vertex;
              mesh.faces.push_back(face);
            } else if (k == 1) {
              face[2] = vertex;
            }
          }
        }
        BITELINE_TRY(body.end_row());
      }
    } else {
      BITELINE_TRY(skip_element(body, element));
    }
  }
  if (mesh.faces.empty())
    return fail(Errc::BadFormat, "%s: element face with at least one triangle expected", name.c_str());
  return mesh;
}

}  // namespace biteline::cloud
