// SPDX-License-Identifier: MIT
#include "host/cloud/ply.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/core/numbers.hpp"
#include "common/system/file.hpp"
#include "host/cloud/ply_file.hpp"
#include "host/cloud/ply_header.hpp"

namespace biteline::cloud {
namespace {

/// A list's length.  Longer ones than the file are ended by its end.
Result<std::size_t> list_length(PlyBody& body, const PlyProperty& list) {
  constexpr NumberRange k_lengths{.minimum = 0, .maximum = 4294967295.0};
  BITELINE_ASSIGN(const double count, body.next(list.count_type));
  if (!k_lengths.holds(count))
    return fail(Errc::BadFormat, "%s: a list's length expected", body.name().c_str());
  return static_cast<std::size_t>(count);
}

/// Passes over a property's value of one row.
Result<void> skip_value(PlyBody& body, const PlyProperty& property) {
  if (!property.is_list) return body.skip(property.type);
  BITELINE_ASSIGN(const std::size_t count, list_length(body, property));
  for (std::size_t k = 0; k < count; ++k) BITELINE_TRY(body.skip(property.type));
  return {};
}

/// Values of the properties `wanted` (rising) of one row, the others untouched.
Result<void> read_row(PlyBody& body, const PlyElement& element, const std::vector<std::size_t>& wanted,
                      std::vector<double>& values) {
  auto next = wanted.begin();
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (next == wanted.end() || *next != i) {
      BITELINE_TRY(skip_value(body, element.properties[i]));
      continue;
    }
    ++next;
    BITELINE_ASSIGN(values[i], body.next(element.properties[i].type));
  }
  return body.end_row();
}

/// Calls `take(values)` with each row's wanted values.
template <class Take>
Result<void> read_rows(PlyBody& body, const PlyElement& element, const std::vector<std::size_t>& wanted,
                       Take&& take) {
  std::vector<double> values(element.properties.size());
  if (body.ascii() || element.has_list()) {
    for (std::size_t row = 0; row < element.count; ++row) {
      BITELINE_TRY(read_row(body, element, wanted, values));
      take(values);
    }
    return {};
  }
  // Rows of one length: a value is found without those before it.
  std::vector<std::size_t> offsets;
  std::size_t row_bytes = 0;
  for (const PlyProperty& property : element.properties) {
    offsets.push_back(row_bytes);
    row_bytes += size_bytes(property.type);
  }
  // Divided, since count * size may overflow in a damaged header.
  constexpr std::size_t k_too_many = std::numeric_limits<std::size_t>::max();
  const std::size_t bytes = element.count > k_too_many / row_bytes ? k_too_many : element.count * row_bytes;
  BITELINE_ASSIGN(const std::string_view rows, body.take_bytes(bytes));
  const bool big_endian = body.big_endian();
  for (std::size_t row = 0; row < element.count; ++row) {
    const char* const raw = rows.data() + row * row_bytes;
    for (const std::size_t i : wanted)
      values[i] = decode_scalar(raw + offsets[i], element.properties[i].type, big_endian);
    take(values);
  }
  return {};
}

Result<void> skip_element(PlyBody& body, const PlyElement& element) {
  // Without properties its rows take no room in the file, however many the header says there are.
  if (element.properties.empty()) return {};
  return read_rows(body, element, {}, [](const auto&) {});
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

  [[nodiscard]] std::vector<std::size_t> there() const {
    std::vector<std::size_t> columns;
    for (const int at :
         {x, y, z, nx, ny, nz, profile, column, sigma_mm, flags, mean_curvature, amplitude, width_px}) {
      if (at >= 0) columns.push_back(static_cast<std::size_t>(at));
    }
    std::ranges::sort(columns);
    return columns;
  }
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

void append(FileContent& content, const CloudColumns& at, const std::vector<double>& row) {
  const auto value = [&](int index) { return row[static_cast<std::size_t>(index)]; };
  content.places.emplace_back(value(at.x), value(at.y), value(at.z));
  PointCloud& cloud = content.beside;
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

bool is_vertex(const PlyElement& element) {
  return element.name == "vertex" || element.name == "vertices" || element.name == "point" ||
         element.name == "points";
}

Result<const PlyElement*> find_vertices(const PlyHeader& header, const std::string& name) {
  if (std::ranges::count_if(header.elements, is_vertex) > 1)
    return fail(Errc::BadFormat, "%s: only one element vertex expected", name.c_str());
  const auto found = std::ranges::find_if(header.elements, is_vertex);
  if (found == header.elements.end())
    return fail(Errc::BadFormat, "%s: element vertex expected", name.c_str());
  for (const char* axis : {"x", "y", "z"}) {
    const int index = found->find(axis);
    if (index < 0 || found->properties[static_cast<std::size_t>(index)].is_list) {
      return fail(Errc::BadFormat, "%s, element vertex: property %s expected", name.c_str(), axis);
    }
  }
  if (found->count == 0)
    return fail(Errc::BadFormat, "%s, element vertex: at least one point expected", name.c_str());
  return &*found;
}

/// A row of a binary file costs at least one byte: a count beyond that is a damaged header, not a reason to
/// ask for memory.
std::size_t plausible_count(const PlyElement& element, std::size_t file_bytes) {
  return std::min(element.count, file_bytes);
}

/// Faces as they come; whether their corners are there is known once all vertices are.
class Faces {
 public:
  Faces(PlyBody& body, const std::string& name, std::vector<std::array<std::uint32_t, 3>>& faces)
      : body_{body}, name_{name}, faces_{faces} {}

  Result<void> read(const PlyElement& element) {
    const bool strips = element.name == "tristrips";
    const std::size_t corners = corners_of(element);
    // As in skip_element().
    for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      number_ = i;
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (p == corners) {
          BITELINE_TRY(strips ? read_strips(element.properties[p]) : read_polygon(element.properties[p]));
        } else {
          BITELINE_TRY(skip_value(body_, element.properties[p]));
        }
      }
      BITELINE_TRY(body_.end_row());
    }
    return {};
  }
  [[nodiscard]] Result<void> check(std::size_t vertices) const {
    if (faces_.empty() || largest_ < vertices) return {};
    return fail(Errc::BadValue, "%s, face %zu: a vertex number below %zu expected", name_.c_str(),
                face_of_largest_, vertices);
  }

 private:
  /// The list of vertex numbers; others hold places on a picture and the like.
  static std::size_t corners_of(const PlyElement& element) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      if (element.properties[i].is_list && element.properties[i].name.starts_with("vert")) return i;
    }
    const auto first = std::ranges::find_if(element.properties, &PlyProperty::is_list);
    return static_cast<std::size_t>(first - element.properties.begin());
  }
  Result<std::uint32_t> corner(double index) {
    constexpr NumberRange k_numbers{.minimum = 0, .maximum = 4294967294.0};
    if (!k_numbers.holds(index)) {
      return fail(Errc::BadValue, "%s, face %zu: a vertex number from 0 expected", name_.c_str(), number_);
    }
    const auto vertex = static_cast<std::uint32_t>(index);
    if (vertex > largest_) face_of_largest_ = number_;
    largest_ = std::max(largest_, vertex);
    return vertex;
  }
  Result<void> read_polygon(const PlyProperty& list) {
    BITELINE_ASSIGN(const std::size_t count, list_length(body_, list));
    std::array<std::uint32_t, 3> face{};
    for (std::size_t k = 0; k < count; ++k) {
      BITELINE_ASSIGN(const double index, body_.next(list.type));
      BITELINE_ASSIGN(const std::uint32_t vertex, corner(index));
      if (k == 0) face[0] = vertex;
      if (k > 0) face[1] = std::exchange(face[2], vertex);
      if (k > 1) faces_.push_back(face);
    }
    return {};
  }
  /// Each corner makes a triangle with the two before it, turned every other time; -1 ends a strip.
  Result<void> read_strips(const PlyProperty& list) {
    BITELINE_ASSIGN(const std::size_t count, list_length(body_, list));
    std::array<std::uint32_t, 2> before{};
    std::size_t length = 0;
    for (std::size_t k = 0; k < count; ++k) {
      BITELINE_ASSIGN(const double index, body_.next(list.type));
      if (index == -1) {
        length = 0;
        continue;
      }
      BITELINE_ASSIGN(const std::uint32_t vertex, corner(index));
      if (length >= 2) {
        const bool turned = length % 2 == 1;
        faces_.push_back({before[turned ? 1 : 0], before[turned ? 0 : 1], vertex});
      }
      before = {before[1], vertex};
      ++length;
    }
    return {};
  }

  PlyBody& body_;
  const std::string& name_;
  std::vector<std::array<std::uint32_t, 3>>& faces_;
  std::size_t number_{0}, face_of_largest_{0};
  std::uint32_t largest_{0};
};

Result<FileContent> read_file(const std::filesystem::path& file) {
  BITELINE_ASSIGN(const std::string bytes, read_regular_file(file, k_most_cloud_bytes));
  return read_ply(bytes, file);
}

const char* encoding_word(PlyEncoding encoding) {
  return encoding == PlyEncoding::Ascii ? "ascii" : "binary";
}

/// As places in mm that are near enough; NaN elsewhere.
Eigen::Vector3f near_or_none(const Eigen::Vector3d& place) {
  if (is_plausible_place(place)) return place.cast<float>();
  return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
}

}  // namespace

Result<FileContent> read_ply(const std::string& bytes, const std::filesystem::path& file) {
  const std::string name = file.string();
  BITELINE_ASSIGN(const PlyHeader header, parse_ply_header(bytes, name));
  BITELINE_ASSIGN(const PlyElement* vertices, find_vertices(header, name));
  PlyBody body{bytes, header, name};
  FileContent content;
  Faces faces{body, name, content.faces};
  for (const PlyElement& element : header.elements) {
    if (&element == vertices) {
      const CloudColumns at{element};
      content.places.reserve(plausible_count(element, bytes.size() / 3));
      BITELINE_TRY(read_rows(body, element, at.there(),
                             [&](const std::vector<double>& row) { append(content, at, row); }));
    } else if (element.name == "face" || element.name == "faces" || element.name == "tristrips") {
      BITELINE_TRY(faces.read(element));
    } else {
      BITELINE_TRY(skip_element(body, element));
    }
  }
  BITELINE_TRY(faces.check(content.places.size()));
  content.layout = std::string{encoding_word(header.encoding)} + " PLY";
  return content;
}

Result<PointCloud> read_cloud(const std::filesystem::path& file, std::size_t* dropped) {
  BITELINE_ASSIGN(FileContent content, read_file(file));
  const std::size_t all = content.places.size();
  std::vector<std::uint8_t> keep(all);
  std::ranges::transform(content.places, keep.begin(),
                         [](const auto& place) { return is_plausible_place(place); });
  PointCloud cloud = kept_of(content, keep);
  if (cloud.points.empty())
    return fail(Errc::BadValue, "%s: no point with finite numbers below 100 m among %zu", file.c_str(), all);
  if (dropped != nullptr) *dropped = all - cloud.points.size();
  return cloud;
}

Result<TriangleMesh> read_mesh(const std::filesystem::path& file) {
  BITELINE_ASSIGN(FileContent content, read_file(file));
  for (Eigen::Vector3d& place : content.places) {
    if (!is_plausible_place(place))
      place = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  // It numbers the corners anew, so the vertices are taken after it.
  leave_out_broken_faces(content);
  TriangleMesh mesh;
  mesh.vertices.reserve(content.places.size());
  for (const Eigen::Vector3d& place : content.places) mesh.vertices.push_back(near_or_none(place));
  mesh.faces = std::move(content.faces);
  if (mesh.faces.empty())
    return fail(Errc::BadFormat, "%s: element face with at least one triangle expected", file.c_str());
  return mesh;
}

}  // namespace biteline::cloud
