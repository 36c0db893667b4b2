// SPDX-License-Identifier: MIT
/// \file The definition of the line's place, as this module spells it out, against a set whose truth others
/// made.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>

#include "hal/sim/shoe/true_line.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::sim {

namespace {

/// The set's surface is a grid: columns of points that leave the outline along its normal.
constexpr std::size_t k_columns = 1200, k_rows = 360;

std::vector<Vec3> read_grid(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::string mark = "end_header\n";
  const std::size_t begin = bytes.find(mark) + mark.size();
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < k_columns * k_rows; ++i) {
    float xyz[3];
    std::memcpy(xyz, bytes.data() + begin + 12 * i, sizeof xyz);
    points.emplace_back(xyz[0], xyz[1], xyz[2]);
  }
  return points;
}

std::vector<Vec3> read_line(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<Vec3> points;
  for (std::string row; std::getline(in, row);) {
    Vec3 p;
    if (std::sscanf(row.c_str(), "%lf,%lf,%lf", &p.x(), &p.y(), &p.z()) == 3) points.push_back(p);
  }
  return points;
}

/// One column as o(z), by a cubic through the four nearest rows (Catmull-Rom in Lagrange's form).
class Column {
 public:
  explicit Column(const Vec3* points) : points_(points) {
    direction_ = (points[k_rows - 1] - points[0]).head<2>().normalized();
  }
  [[nodiscard]] double offset_mm(double z_mm) const {
    const Vec3* above = std::upper_bound(points_ + 2, points_ + k_rows - 2, z_mm,
                                         [](double z, const Vec3& p) { return z < p.z(); });
    double sum = 0;
    for (int i = -2; i < 2; ++i) {
      double weight = 1;
      for (int k = -2; k < 2; ++k) {
        if (k != i) weight *= (z_mm - above[k].z()) / (above[i].z() - above[k].z());
      }
      sum += weight * (above[i] - points_[0]).head<2>().dot(direction_);
    }
    return -sum;  // the wall leans inwards: the direction found is the inward one
  }
  [[nodiscard]] Vec3 point(double z_mm) const {
    const Vec2 place = points_[0].head<2>() - offset_mm(z_mm) * direction_;
    return {place.x(), place.y(), z_mm};
  }

 private:
  const Vec3* points_;
  Vec2 direction_;
};

}  // namespace

TEST_GROUP(ReferenceTruth){};

TEST(ReferenceTruth, SameDefinitionGivesTheSameLine) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "sessions/sport3/truth");
  const std::vector<Vec3> grid = read_grid(folder / "reference.ply"),
                          truth = read_line(folder / "groove.csv");
  LONGS_EQUAL(k_columns, truth.size());

  std::vector<SmoothedSection> sections;
  for (std::size_t i = 0; i < k_columns; ++i) {
    const Column column(&grid[i * k_rows]);
    sections.push_back(
        smoothed_section([&](double z_mm) { return column.offset_mm(z_mm); }, truth[i].z(), {}));
  }
  const LineHeights heights = line_heights(sections, 628.3 / k_columns, {});
  double worst_mm = 0, sum_mm = 0;
  for (std::size_t i = 0; i < k_columns; ++i) {
    const Column column(&grid[i * k_rows]);
    const double error_mm = (column.point(heights.z_mm[i]) - truth[i]).norm();
    worst_mm = std::max(worst_mm, error_mm);
    sum_mm += error_mm;
  }
  // The set's grid is 0.14 to 0.23 mm fine near the line.
  CHECK(sum_mm / k_columns < 0.02);
  CHECK(worst_mm < 0.1);
  test::note_ran();
}

}  // namespace biteline::sim
