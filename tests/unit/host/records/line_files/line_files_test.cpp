// SPDX-License-Identifier: MIT
#include "host/records/line_files/line_file.hpp"

#include <CppUTest/TestHarness.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>

#include "host/records/line_files/spline.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::line_files {
namespace {

/// An ellipse of a shoe's size that rises and falls, a point each 2 mm or so.
cloud::ClosedLine made_line() {
  cloud::ClosedLine line;
  constexpr int k_points = 300;
  for (int i = 0; i < k_points; ++i) {
    const double t = 2 * std::numbers::pi * i / k_points;
    line.points.push_back({.position = {140 * std::cos(t), 45 * std::sin(t), 20 + 4 * std::cos(2 * t)},
                           .normal = {std::cos(t), std::sin(t), 0},
                           .tangent = {-std::sin(t), std::cos(t), 0},
                           .confidence = 0.9,
                           .u95_mm = i % 2 == 0 ? std::optional{0.1} : std::nullopt});
  }
  return line;
}

struct Told {
  int status{0};
  std::string words;
};

Told told_by(const std::string& command) {
  Told told;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  CHECK(pipe != nullptr);
  char buffer[4096];
  while (std::size_t count = std::fread(buffer, 1, sizeof buffer, pipe)) told.words.append(buffer, count);
  told.status = WEXITSTATUS(::pclose(pipe));
  return told;
}

}  // namespace

TEST_GROUP(LineFile) {
  test::TemporaryFolder folder;
  cloud::ClosedLine line = made_line();

  std::filesystem::path written(const std::string& name) {
    const std::filesystem::path file = folder.path() / name;
    SUCCEEDS(write_line_file(file, line));
    return file;
  }
};

TEST(LineFile, EndOfTheNameChoosesTheFormat) {
  for (const char* name : {"a.csv", "a.ply", "a.dxf", "a.step", "a.STP", "a.json"})
    CHECK(std::filesystem::file_size(written(name)) > 1000);
  FAILS_NAMING(Errc::InvalidArgument, ".csv .ply .dxf", write_line_file(folder.path() / "a.iges", line));
}

TEST(LineFile, CsvIsTheProductsOwn) {
  const auto sut = cloud::read_line(written("a.csv"));
  SUCCEEDS(sut);
  LONGS_EQUAL(line.points.size(), sut->points.size());
}

TEST(LineFile, JsonHasEveryColumn) {
  std::ifstream file(written("a.json"));
  const nlohmann::json sut = test::read_json(file);
  LONGS_EQUAL(line.points.size(), sut.at("points").size());
  const auto& second = sut.at("points").at(1);
  DOUBLES_EQUAL(line.points[1].position.x(), second.at("position_mm").at(0).get<double>(), 1e-9);
  CHECK(second.at("u95_mm").is_null());
  STRCMP_EQUAL("seen", second.at("source").get<std::string>().c_str());
  DOUBLES_EQUAL(cloud::length_mm(line), sut.at("length_mm").get<double>(), 1e-6);
}

TEST(LineFile, PlyClosesWithItsLastEdge) {
  std::ifstream file(written("a.ply"));
  std::string row, last;
  while (std::getline(file, row)) last = row;
  STRCMP_EQUAL("299 0", last.c_str());
}

TEST(LineFile, SplineGoesThroughEveryPointAndTurnsSmoothly) {
  line.points.insert(line.points.begin() + 5, line.points[5]);  // a point twice adds nothing
  const ClosedSpline sut = spline_through(line);
  LONGS_EQUAL(301, sut.knots.size());
  LONGS_EQUAL(901, sut.control.size());
  DOUBLES_EQUAL(0, (sut.control.front() - sut.control.back()).norm(), 1e-12);
  for (std::size_t i = 1; i < 300; ++i) {
    const Vec3 before = (sut.control[3 * i] - sut.control[3 * i - 1]) / (sut.knots[i] - sut.knots[i - 1]);
    const Vec3 after = (sut.control[3 * i + 1] - sut.control[3 * i]) / (sut.knots[i + 1] - sut.knots[i]);
    DOUBLES_EQUAL(0, (before - after).norm(), 1e-12);
    // Between the points it leaves the ellipse by less than the fourth power of a step of 0.021 rad.
    const Vec3 middle = (sut.control[3 * i] + 3 * sut.control[3 * i + 1] + 3 * sut.control[3 * i + 2] +
                         sut.control[3 * i + 3]) /
                        8;
    DOUBLES_EQUAL(1, std::hypot(middle.x() / 140, middle.y() / 45), 1e-6);
  }
}

/// Some readers make no layer by themselves.
TEST(LineFile, EachLayerThatTheDxfUsesStandsInItsTable) {
  std::ifstream file{written("a.dxf")};
  std::set<std::string> known, used;
  bool in_table = false;
  std::string code, value, kind;
  while (std::getline(file, code) && std::getline(file, value)) {
    const int number = std::stoi(code);
    if (number == 0) kind = value;
    if (number == 0 && value == "ENDTAB") in_table = false;
    if (number == 2 && kind == "TABLE") in_table = value == "LAYER";
    if (number == 2 && kind == "LAYER" && in_table) known.insert(value);
    if (number == 8) used.insert(value);
  }
  CHECK(used.contains("BITE_LINE"));
  for (const std::string& layer : used) CHECK_TEXT(known.contains(layer), layer.c_str());
}

TEST(LineFile, EzdxfReadsTheDxf) {
  const Told told =
      told_by(std::string("/usr/bin/python3 ") + BITELINE_DXF_JUDGE + " " + written("a.dxf").string());
  if (told.status == 77) {
    UT_PRINT("skipped: python3-ezdxf is not installed");
    return;
  }
  LONGS_EQUAL(0, told.status);
  std::istringstream words{told.words};
  int closed = 0, unit = 0;
  words >> closed >> unit;
  LONGS_EQUAL(1, closed);
  LONGS_EQUAL(4, unit);
  for (const cloud::LinePoint& p : line.points) {
    Vec3 place;
    CHECK(static_cast<bool>(words >> place.x() >> place.y() >> place.z()));
    DOUBLES_EQUAL(0, (place - p.position).norm(), 1e-5);
  }
}

TEST(LineFile, OpenCascadeReadsTheStep) {
#ifdef BITELINE_STEP_JUDGE
  const Told told = told_by(std::string(BITELINE_STEP_JUDGE) + " " + written("a.step").string() + " " +
                            written("a.csv").string() + " | tail -1");
  std::istringstream words{told.words};
  int edges = 0, closed = 0;
  double length = 0, worst = 1;
  CHECK_TEXT(static_cast<bool>(words >> edges >> closed >> length >> worst), told.words.c_str());
  LONGS_EQUAL(1, edges);
  LONGS_EQUAL(1, closed);
  // A fiftieth of the product's aim of 0.05 mm; six decimals in the file leave 0.000001.
  CHECK(worst < 0.001);
  // A curve is longer than its chords by about (step / radius)^2 / 24 of itself: below 1 in 10 000 here.
  CHECK(length >= cloud::length_mm(line) && length < 1.0002 * cloud::length_mm(line));
#else
  UT_PRINT("skipped: OpenCASCADE is not installed (libocct-data-exchange-dev)");
#endif
}

}  // namespace biteline::line_files
