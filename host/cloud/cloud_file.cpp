// SPDX-License-Identifier: MIT
#include "host/cloud/cloud_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/core/fixed_text.hpp"
#include "common/core/numbers.hpp"
#include "common/system/file.hpp"
#include "host/cloud/file_content.hpp"
#include "host/cloud/letters.hpp"
#include "host/cloud/mesh_file.hpp"
#include "host/cloud/nothing_values.hpp"
#include "host/cloud/pcd.hpp"
#include "host/cloud/ply_file.hpp"
#include "host/cloud/sample_surface.hpp"
#include "host/cloud/text_cloud.hpp"

namespace biteline::cloud {
namespace {

namespace fs = std::filesystem;

/// As dense as a scan: profiles every 0.5 mm, columns closer.
constexpr double k_mesh_spacing_mm = 0.35;
/// Farther away a float's steps grow to a part of what is measured.
constexpr double k_near_mm = 10'000;
constexpr std::size_t k_most_looked_at = 20'000;

bool is_one_of(const std::string& text, std::initializer_list<const char*> names) {
  return std::ranges::any_of(names, [&](const char* name) { return text == name; });
}

Result<FileContent> read_content(const fs::path& file) {
  const std::string type = small_letters(file.extension().string());
  std::error_code error;
  if (fs::is_directory(file, error)) {
    return fail(Errc::BadFormat,
                "%s: a folder, and a cloud's file expected; `biteline replay` takes a session's folder",
                file.c_str());
  }
  const bool text = is_one_of(type, {".xyz", ".txt", ".asc", ".csv", ".pts"});
  if (!text && !is_one_of(type, {".ply", ".pcd", ".stl", ".obj"})) {
    return fail(Errc::BadFormat, "%s: a cloud expected: .ply .xyz .txt .asc .csv .pts .pcd .stl .obj",
                file.c_str());
  }
  BITELINE_ASSIGN(std::string bytes, read_regular_file(file, k_most_cloud_bytes));
  if (text) return read_text_cloud(std::move(bytes), file);
  if (type == ".ply") return read_ply(bytes, file);
  if (type == ".pcd") return read_pcd(bytes, file);
  if (type == ".stl") return read_stl(std::move(bytes), file);
  return read_obj(std::move(bytes), file);
}

/// A mesh, and no cloud with a face or two in it.
bool is_mesh(const FileContent& content) {
  if (content.faces.empty()) return false;
  std::vector<std::uint8_t> used(content.places.size(), 0);
  for (const auto& face : content.faces) {
    for (const std::uint32_t corner : face) used[corner] = 1;
  }
  return 2 * static_cast<std::size_t>(std::ranges::count(used, 1)) >= used.size();
}

/// mm of one unit along each axis.  What the file says counts; nobody may say otherwise.
Result<Eigen::Array3d> scale_of(const FileContent& content, const fs::path& file, CloudFile& read) {
  std::optional<Unit> any;
  for (const auto& unit : content.unit) {
    if (!any) any = unit;
  }
  if (!any) return Eigen::Array3d(Eigen::Array3d::Constant(mm_per(read.unit.value_or(Unit::Millimetre))));
  Eigen::Array3d scale;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Unit unit = content.unit[axis].value_or(*any);
    if (read.unit && *read.unit != unit) {
      return fail(Errc::BadValue,
                  "%s: its head says %c is in %s, and --unit says %s: leave --unit out, or mend the head",
                  file.c_str(), static_cast<char>('x' + axis), unit_row(unit).name,
                  unit_row(*read.unit).name);
    }
    scale[static_cast<Eigen::Index>(axis)] = mm_per(unit);
  }
  read.unit = any;
  return scale;
}

/// "3 512".
std::string grouped(std::size_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ' ');
  return text;
}

/// Low, middle and high of the kept places' coordinates: 1 %, 50 % and 99 %.
std::array<Eigen::Vector3d, 3> spread_of(const std::vector<Eigen::Vector3d>& places,
                                         const std::vector<std::uint8_t>& keep) {
  std::array<Eigen::Vector3d, 3> spread{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  std::vector<std::size_t> sample = spread_numbers(places.size(), k_most_looked_at);
  std::erase_if(sample, [&](std::size_t i) { return keep[i] == 0; });
  if (sample.empty()) return spread;
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (const std::size_t i : sample) values.push_back(places[i][axis]);
    std::ranges::sort(values);
    const std::size_t cut = values.size() / 100;
    spread[0][axis] = values[cut];
    spread[1][axis] = values[(values.size() - 1) / 2];
    spread[2][axis] = values[values.size() - 1 - cut];
  }
  return spread;
}

void leave_out(CloudFile& read, std::string why, std::size_t points) {
  if (points == 0) return;
  read.dropped += points;
  read.left_out.push_back({std::move(why), points});
}

/// The content's places in mm, z up and near the origin; what is not kept is told.
class Placing {
 public:
  Placing(FileContent& content, const Reading& reading, const Eigen::Array3d& scale, CloudFile& read)
      : content_{content},
        keep_(content.places.size()),
        read_{read},
        turn_{turn_of(reading.up)},
        scale_{scale} {
    std::ranges::transform(content.places, keep_.begin(),
                           [](const auto& place) { return place.allFinite(); });
  }

  Result<void> place(bool mesh) {
    leave_out(read_, "no number",
              content_.without_number + static_cast<std::size_t>(std::ranges::count(keep_, 0)));
    if (!mesh) {
      for (const NothingValue& nothing : leave_out_nothing(content_.places, keep_))
        leave_out(read_, nothing.value + " stands for nothing", nothing.points);
    }
    if (!(scale_ == 1).all() || !turn_.isIdentity()) {
      for (Eigen::Vector3d& place : content_.places) place = turn_ * (place.array() * scale_).matrix();
      for (Eigen::Vector3f& normal : content_.beside.normals) normal = turn_.cast<float>() * normal;
    }
    const auto [low, middle, high] = spread_of(content_.places, keep_);
    read_.size_mm = (high - low).maxCoeff();
    choose_origin(middle);
    if (!read_.origin.isZero()) {
      for (Eigen::Vector3d& place : content_.places) place -= read_.origin;
    }
    std::size_t far = 0;
    for (std::size_t i = 0; i < keep_.size(); ++i) {
      if (keep_[i] == 0 || is_plausible_place(content_.places[i])) continue;
      keep_[i] = 0;
      ++far;
    }
    if (mesh) return sample();
    leave_out(read_, "beyond 100 m", far);
    read_.cloud = kept_of(content_, keep_);
    return {};
  }

 private:
  /// Whole metres, so that a person can add them by hand.
  void choose_origin(const Eigen::Vector3d& middle) {
    if (middle.cwiseAbs().maxCoeff() <= k_near_mm) return;
    for (int axis = 0; axis < 3; ++axis) {
      const double metres = std::round(middle[axis] / 1000);
      // Beyond it a double's steps are no part of a millimetre's hundredth any more.
      if (std::abs(metres) < 1e8) read_.origin[axis] = 1000 * metres;
    }
  }

  Result<void> sample() {
    for (std::size_t i = 0; i < keep_.size(); ++i) {
      if (keep_[i] == 0) content_.places[i].setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    content_.without_number = 0;
    leave_out_broken_faces(content_);
    leave_out(read_, "triangles beyond 100 m", content_.without_number);
    TriangleMesh mesh;
    mesh.vertices = kept_of(content_, std::vector<std::uint8_t>(content_.places.size(), 1)).points;
    mesh.faces = std::move(content_.faces);
    BITELINE_ASSIGN(read_.cloud.points, sample_surface(mesh, k_mesh_spacing_mm));
    // In another unit its surface is too small for a single one: its size is what matters then.
    if (read_.cloud.points.empty()) read_.cloud.points = std::move(mesh.vertices);
    return {};
  }

  FileContent& content_;
  std::vector<std::uint8_t> keep_;
  CloudFile& read_;
  Eigen::Matrix3d turn_;
  Eigen::Array3d scale_;
};

std::string words_of_reading(const CloudFile& read, const FileContent& content, std::size_t triangles,
                             Up up) {
  std::string words = grouped(read.cloud.size()) + " points";
  if (triangles > 0) words += " on " + grouped(triangles) + " triangles";
  words += ", " + content.layout;
  if (read.unit) words += std::string{", in "} + unit_row(*read.unit).name;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (content.unit[axis] && content.unit[axis] != read.unit)
      words +=
          std::string{", "} + static_cast<char>('x' + axis) + " in " + unit_row(*content.unit[axis]).name;
  }
  if (up != Up::Z) words += std::string{", its "} + up_word(up) + " up";
  if (!read.origin.isZero()) {
    words += FixedText<120>::format(", %.0f %.0f %.0f m from its origin", read.origin.x() / 1000,
                                    read.origin.y() / 1000, read.origin.z() / 1000)
                 .view();
  }
  if (read.dropped > 0) words += "; " + grouped(read.dropped) + " left out: ";
  for (std::size_t i = 0; i < read.left_out.size(); ++i) {
    if (i > 0) words += ", ";
    if (read.left_out.size() > 1) words += grouped(read.left_out[i].points) + " ";
    words += read.left_out[i].why;
  }
  return words;
}

}  // namespace

const char* up_word(Up up) {
  switch (up) {
    case Up::MinusZ:
      return "-z";
    case Up::Y:
      return "y";
    case Up::MinusY:
      return "-y";
    case Up::X:
      return "x";
    case Up::MinusX:
      return "-x";
    case Up::Z:
      break;
  }
  return "z";
}

Eigen::Matrix3d turn_of(Up up) {
  Eigen::Matrix3d turn;
  switch (up) {
    case Up::MinusZ:
      turn << 1, 0, 0, 0, -1, 0, 0, 0, -1;
      return turn;
    case Up::Y:
      turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
      return turn;
    case Up::MinusY:
      turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
      return turn;
    case Up::X:
      turn << 0, 0, -1, 0, 1, 0, 1, 0, 0;
      return turn;
    case Up::MinusX:
      turn << 0, 0, 1, 0, 1, 0, -1, 0, 0;
      return turn;
    case Up::Z:
      break;
  }
  return Eigen::Matrix3d::Identity();
}

Result<CloudFile> read_cloud_file(const fs::path& file, const Reading& reading) {
  BITELINE_ASSIGN(FileContent content, read_content(file));
  CloudFile read;
  read.unit = reading.unit;
  BITELINE_ASSIGN(const Eigen::Array3d scale, scale_of(content, file, read));
  const bool mesh = is_mesh(content);
  if (mesh) {
    const std::size_t all = content.faces.size();
    leave_out_broken_faces(content);
    leave_out(read, "triangles without numbers", std::exchange(content.without_number, 0));
    if (content.faces.empty())
      return fail(Errc::BadValue, "%s: none of its %zu triangles has numbers", file.c_str(), all);
  }
  const std::size_t triangles = mesh ? content.faces.size() : 0,
                    places = content.places.size() + content.without_number;
  BITELINE_TRY(Placing(content, reading, scale, read).place(mesh));
  if (read.cloud.points.empty())
    return fail(Errc::BadValue, "%s: no point with numbers among %zu", file.c_str(), places);
  read.understood = words_of_reading(read, content, triangles, reading.up);
  return read;
}

}  // namespace biteline::cloud
