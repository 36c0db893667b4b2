// SPDX-License-Identifier: MIT
// Meshes of real and drawn shoes, sampled as a scanner would see them.  Bounds in mm: what the product
// promises for them.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "host/groove/extract.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/mesh_cloud.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline {

namespace fs = std::filesystem;

TEST_GROUP(Shoes) {
  static groove::Extraction line_of(const fs::path& mesh_file) {
    const auto mesh = cloud::read_mesh(mesh_file);
    SUCCEEDS(mesh);
    return groove::extract(test::scan_mesh(*mesh, {}), {.keep_products = false});
  }

  struct Boundary {
    double x_mm, z_mm;
  };
  /// Columns x, y, z, step; from 10 % to 90 % of the length.
  static std::vector<Boundary> truth(const fs::path& file) {
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
    const double length =
        std::max_element(rows.begin(), rows.end(), [](auto& a, auto& b) { return a.x_mm < b.x_mm; })->x_mm;
    std::erase_if(rows,
                  [&](const Boundary& row) { return row.x_mm < 0.1 * length || row.x_mm > 0.9 * length; });
    return rows;
  }

  /// Mean difference in height at equal x on one side of the shoe; the meshes' x runs from heel to toe, y to
  /// the left.
  static double height_error_mm(const line::ClosedLine& line, const std::vector<Boundary>& boundary,
                                bool left) {
    double sum = 0;
    for (const Boundary& row : boundary) {
      double nearest = 1e9;
      double z = 0;
      for (const auto& point : line.points) {
        // The normal tells the sides apart where the outline is not symmetric about y = 0.
        if ((point.normal.y() > 0) != left || std::abs(point.position.x() - row.x_mm) >= nearest) continue;
        nearest = std::abs(point.position.x() - row.x_mm);
        z = point.position.z();
      }
      sum += std::abs(z - row.z_mm) / static_cast<double>(boundary.size());
    }
    return sum;
  }

  static void check_boundary(const char* shoe) {
    BITELINE_SHARED_DATA_OR_SKIP(mesh, std::string{"shoes/"} + shoe + "/mesh_mm.ply");
    const groove::Extraction sut = line_of(mesh);
    CHECK_TEXT(sut.found, sut.reason.c_str());
    for (const bool left : {true, false}) {
      BITELINE_SHARED_DATA_OR_SKIP(file,
                                   std::string{"shoes/truth/"} + shoe + (left ? "_left.csv" : "_right.csv"));
      CHECK_COMPARE(height_error_mm(sut.line, truth(file), left), <=, 0.5);
    }
  }
};

TEST(Shoes, SneakerBoundaryIsFoundOnBothSides) {
  check_boundary("s15_mit_sneaker");
}

TEST(Shoes, LabelledShoeBoundaryIsFoundOnBothSides) {
  check_boundary("s24_khronos_shoe_with_part_labels");
}

TEST(Shoes, TheBiteLineIsChosenAndNotTheGrooveBelowIt) {
  BITELINE_SHARED_DATA_OR_SKIP(mesh, "shoes/s06_nike_pegasus36/mesh_mm.ply");
  const groove::Extraction sut = line_of(mesh);
  CHECK_TEXT(sut.found, sut.reason.c_str());
  // From 10 to 90 % of the length: along the sides the line runs between 22 and 38 mm, lowest at the forefoot; the
  // groove lies 8 to 12 mm below it, so that a line which leaves the upper one by more than 3 mm anywhere, measured
  // against its own course over 60 mm, has gone astray.
  const auto& points = sut.line.points;
  const auto by_x = [](const auto& a, const auto& b) { return a.position.x() < b.position.x(); };
  const double heel = std::min_element(points.begin(), points.end(), by_x)->position.x();
  const double length = std::max_element(points.begin(), points.end(), by_x)->position.x() - heel;
  const auto reach = static_cast<std::size_t>(30.0 / 0.5);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double share = (points[i].position.x() - heel) / length;
    if (share < 0.1 || share > 0.9) continue;
    std::vector<double> course;
    for (std::size_t k = 0; k <= 2 * reach; k += 4)
      course.push_back(points[(i + points.size() + k - reach) % points.size()].position.z());
    std::nth_element(course.begin(), course.begin() + static_cast<std::ptrdiff_t>(course.size() / 2), course.end());
    CHECK_COMPARE(std::abs(points[i].position.z() - course[course.size() / 2]), <=, 3.0);
    CHECK_COMPARE(points[i].position.z(), >, 19.0);
    CHECK_COMPARE(points[i].position.z(), <, 41.0);
    if (points[i].position.x() < 120) CHECK_COMPARE(points[i].position.z(), >, 32.0);
  }
}

TEST(Shoes, ASmoothFilletIsNoBiteLine) {
  BITELINE_SHARED_DATA_OR_SKIP(mesh, "shoes/s21_smooth_fillet_hightop/mesh_mm.ply");
  const groove::Extraction sut = line_of(mesh);
  CHECK_FALSE(sut.found);
  CHECK_COMPARE(sut.confidence, <, 0.5);
}

}  // namespace biteline
