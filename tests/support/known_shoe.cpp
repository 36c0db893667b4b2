// SPDX-License-Identifier: MIT
#include "tests/support/known_shoe.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

#include "common/core/contracts.hpp"
#include "tests/support/mesh_cloud.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::test {
namespace {

namespace fs = std::filesystem;

constexpr double k_boundary_mm = 0.5;  ///< mean height error of a side
constexpr double k_course_mm = 3.0;
/// Share of the length within which both truths hold.
constexpr double k_from = 0.1, k_to = 0.9;

struct Boundary {
  double x_mm, z_mm;
};
/// Columns x, y, z, step.
std::vector<Boundary> read_boundary(const fs::path& file) {
  std::vector<Boundary> rows;
  std::ifstream in{file};
  for (std::string text; std::getline(in, text);) {
    if (text.starts_with('#')) continue;
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream fields{text};
    double x = 0, y = 0, z = 0;
    fields >> x >> y >> z;
    rows.push_back({x, z});
  }
  BITELINE_EXPECTS(!rows.empty());
  const double length =
      std::max_element(rows.begin(), rows.end(), [](auto& a, auto& b) { return a.x_mm < b.x_mm; })->x_mm;
  std::erase_if(rows,
                [&](const Boundary& row) { return row.x_mm < k_from * length || row.x_mm > k_to * length; });
  return rows;
}

/// Mean difference in height at equal x on one side of the shoe; the meshes' x runs from heel to toe, y to
/// the left.
double height_error_mm(const cloud::ClosedLine& line, const std::vector<Boundary>& boundary, bool left) {
  double sum = 0;
  for (const Boundary& row : boundary) {
    double nearest = 1e9, z = 0;
    for (const cloud::LinePoint& point : line.points) {
      // The normal tells the sides apart where the outline is not symmetric about y = 0.
      if ((point.normal.y() > 0) != left || std::abs(point.position.x() - row.x_mm) >= nearest) continue;
      nearest = std::abs(point.position.x() - row.x_mm);
      z = point.position.z();
    }
    sum += std::abs(z - row.z_mm) / static_cast<double>(boundary.size());
  }
  return sum;
}

ShoeVerdict judge_boundary(const std::string& name, const cloud::ClosedLine& line) {
  double worse_mm = 0;
  for (const bool left : {true, false}) {
    const auto file = shared_data("shoes/truth/" + name + (left ? "_left.csv" : "_right.csv"));
    BITELINE_EXPECTS(file.has_value());
    worse_mm = std::max(worse_mm, height_error_mm(line, read_boundary(*file), left));
  }
  return {worse_mm <= k_boundary_mm, worse_mm, "off the sole's edge"};
}

/// Along the sides the line runs between 22 and 38 mm, lowest at the forefoot, and the groove 8 to 12 mm
/// below it: a line that leaves the upper one by more than 3 mm anywhere, measured against its own course
/// over 60 mm, has gone astray.
ShoeVerdict judge_course(const cloud::ClosedLine& line) {
  const std::vector<cloud::LinePoint>& points = line.points;
  const auto by_x = [](const auto& a, const auto& b) { return a.position.x() < b.position.x(); };
  const double heel = std::min_element(points.begin(), points.end(), by_x)->position.x();
  const double length = std::max_element(points.begin(), points.end(), by_x)->position.x() - heel;
  const auto reach = static_cast<std::size_t>(30.0 / 0.5);
  ShoeVerdict verdict{.right = true, .off_mm = 0, .why = {}};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& at = points[i].position;
    const double share = (at.x() - heel) / length;
    if (share < k_from || share > k_to) continue;
    std::vector<double> course;
    for (std::size_t k = 0; k <= 2 * reach; k += 4)
      course.push_back(points[(i + points.size() + k - reach) % points.size()].position.z());
    std::nth_element(course.begin(), course.begin() + std::ssize(course) / 2, course.end());
    verdict.off_mm = std::max(verdict.off_mm, std::abs(at.z() - course[course.size() / 2]));
    if (at.z() < (at.x() < 120 ? 32.0 : 19.0) || at.z() > 41.0)
      return {false, verdict.off_mm, "on the groove below, or above"};
  }
  if (verdict.off_mm > k_course_mm) return {false, verdict.off_mm, "leaves its course"};
  return verdict;
}

}  // namespace

std::optional<cloud::PointCloud> scan_of(const KnownShoe& shoe) {
  const auto file = shared_data(std::string{"shoes/"} + shoe.name + "/mesh_mm.ply");
  if (!file) return std::nullopt;
  const auto mesh = cloud::read_mesh(*file);
  BITELINE_EXPECTS(mesh.has_value());
  return scan_mesh(*mesh, {});
}

ShoeVerdict judge(const KnownShoe& shoe, const bite_line::Extraction& extraction) {
  if (shoe.truth == KnownShoe::Truth::NoLine)
    return {!extraction.found && extraction.confidence < 0.5, 0, "a line where there is none"};
  if (!extraction.found) return {false, 0, "refused: " + extraction.reason()};
  return shoe.truth == KnownShoe::Truth::Boundary ? judge_boundary(shoe.name, extraction.line)
                                                  : judge_course(extraction.line);
}

}  // namespace biteline::test
