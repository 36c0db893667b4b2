// SPDX-License-Identifier: MIT
// Clouds and meshes of other people's programs: what stands for nothing, far places, axes, meshes of all
// kinds.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "host/cloud/cloud_file.hpp"
#include "host/cloud/far_line.hpp"
#include "host/cloud/ply_file.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::cloud {

TEST_GROUP(ForeignCloud) {
  test::TemporaryFolder folder;

  Result<CloudFile> read(const std::string& name, const std::string& text, const Reading& reading = {})
      const {
    return read_cloud_file(folder.write(name, text), reading);
  }
  /// Rows of a surface that was measured: no place twice.
  static std::string surface(int count) {
    std::mt19937 random{3};
    std::uniform_real_distribution<double> at{-100, 100}, height{30, 120};
    std::string rows;
    for (int i = 0; i < count; ++i)
      rows += std::to_string(at(random)) + " " + std::to_string(at(random)) + " " +
              std::to_string(height(random)) + "\n";
    return rows;
  }
  void keeps(const std::string& text, std::size_t points, std::size_t left_out, const char* words = "")
      const {
    const auto sut = read("a.xyz", text);
    SUCCEEDS(sut);
    STRCMP_CONTAINS(words, sut->understood.c_str());
    LONGS_EQUAL_TEXT(points, sut->cloud.size(), sut->understood.c_str());
    LONGS_EQUAL_TEXT(left_out, sut->dropped, sut->understood.c_str());
  }
};

TEST(ForeignCloud, OnePlaceOfManyPointsStandsForNothing) {
  const std::string rows = surface(500);
  std::string zeros, far, largest;
  for (int i = 0; i < 250; ++i) {
    zeros += "0 0 0\n";
    far += "-9999 -9999 -9999\n";
    largest += "3.40282347e+38 3.40282347e+38 3.40282347e+38\n";
  }
  keeps(rows + zeros, 500, 250, "250 left out: 0 0 0 stands for nothing");
  keeps(zeros + rows, 500, 250);
  keeps(rows + far, 500, 250, "-9999 -9999 -9999 stands for nothing");
  keeps(rows + largest + zeros, 500, 500);
  // Every other row, as a regular grid with holes has them.
  std::string turns;
  for (std::size_t begin = 0, end = 0; (end = rows.find('\n', begin)) != std::string::npos; begin = end + 1)
    turns += rows.substr(begin, end + 1 - begin) + "0.000 0.000 0.000\n";
  keeps(turns, 500, 500);
  DOUBLES_EQUAL(200, read("a.xyz", turns)->size_mm, 10);
}

TEST(ForeignCloud, OneHeightFarFromAllOthersStandsForNothing) {
  std::string holes, unusual;
  for (int i = 0; i < 40; ++i) {
    holes += std::to_string(i) + " 7 -32768\n";
    unusual += std::to_string(i) + " 7 -251\n";
  }
  keeps(surface(500) + holes, 500, 40, "z -32768 stands for nothing");
  keeps(surface(500) + unusual, 500, 40);
  keeps(holes + surface(500) + unusual, 500, 80);
}

TEST(ForeignCloud, SurfacesAndTruePointsStay) {
  // A table at z = 0 that goes over into a shoe's side, and a drawn box of two planes.
  std::string table = surface(300), box;
  for (int i = 0; i < 900; ++i) {
    table += std::to_string(i % 30) + " " + std::to_string(i / 30) + " 0\n";
    if (i % 10 == 0) table += "200 " + std::to_string(i) + " " + std::to_string(0.1 * i) + "\n";
    box += std::to_string(i % 30) + " " + std::to_string(i / 30) + (i % 2 == 0 ? " 0\n" : " 50\n");
  }
  keeps(table, 300 + 900 + 90, 0);
  keeps(box, 900, 0);
  keeps("0 0 0\n" + surface(500), 501, 0);
  keeps("1 2 3\n1 2 3\n4 5 6\n4 5 6\n7 8 9\n7 8 9\n", 6, 0);  // each point twice
  // The one that is at home there stays, 20 others go.
  std::string corner = box;
  for (int i = 0; i < 20; ++i) corner += "0 0 0\n";
  keeps(corner, 900, 20);
}

TEST(ForeignCloud, FarFromItsOriginNoDigitIsLost) {
  const std::string grid =
      "694386.201 5155487.512 312.001\n694386.202 5155487.513 312.004\n694386.303 5155487.614 312.1\n";
  const auto metres = read("a.xyz", grid, {.unit = Unit::Metre});
  SUCCEEDS(metres);
  LONGS_EQUAL(3, metres->cloud.size());
  CHECK(((metres->cloud.points[1] - metres->cloud.points[0]) - Eigen::Vector3f(1, 1, 3)).norm() < 0.001);
  const Vec3 first = metres->cloud.points[0].cast<double>() + metres->origin;
  CHECK((first - Vec3(694386201, 5155487512, 312001)).norm() < 0.01);
  STRCMP_CONTAINS("m from its origin", metres->understood.c_str());
  const auto mm = read("a.csv", "x,y,z\n694386.2,5155487.5,12\n694387.2,5155487.5,13\n");
  SUCCEEDS(mm);
  DOUBLES_EQUAL(1, (mm->cloud.points[1] - mm->cloud.points[0]).x(), 1e-3);
  // Near ones stay where they are.
  CHECK(read("a.xyz", surface(50))->origin.isZero());
  // What is written far away comes back there.
  SUCCEEDS(write_far_cloud(folder.path() / "far.ply", metres->cloud, metres->origin));
  const auto again = read_cloud_file(folder.path() / "far.ply");
  SUCCEEDS(again);
  CHECK((again->origin - metres->origin).norm() < 1e-9);
  CHECK((again->cloud.points[2] - metres->cloud.points[2]).norm() < 0.001);
}

TEST(ForeignCloud, LineFarAwayIsReadWhereItMayBe) {
  ClosedLine line;
  for (int i = 0; i < 4; ++i)
    line.points.push_back({.position = Vec3(694386201.125 + i, 5155487512.5, 3),
                           .normal = Vec3::UnitZ(),
                           .tangent = Vec3::UnitX(),
                           .confidence = 1});
  const auto file = folder.path() / "line.csv";
  SUCCEEDS(write_line(file, line));
  const auto far = read_far_line(file);
  SUCCEEDS(far);
  CHECK((far->points[3].position - line.points[3].position).norm() < 1e-4);
  SUCCEEDS(read_far_positions(file));
  FAILS_NAMING(Errc::BadValue, "row 2", read_line(file));  // nothing that an arm could follow
}

TEST(ForeignCloud, AxesAreTurnedWhenTold) {
  for (const auto& [up, file_up] : {std::pair{Up::Z, Vec3(0, 0, 1)},
                                    {Up::MinusZ, Vec3(0, 0, -1)},
                                    {Up::Y, Vec3(0, 1, 0)},
                                    {Up::MinusY, Vec3(0, -1, 0)},
                                    {Up::X, Vec3(1, 0, 0)},
                                    {Up::MinusX, Vec3(-1, 0, 0)}}) {
    const Eigen::Matrix3d turn = turn_of(up);
    CHECK((turn * file_up - Vec3::UnitZ()).norm() < 1e-12);
    DOUBLES_EQUAL(1, turn.determinant(), 1e-12);
    const auto sut = read("a.xyz", "1 2 3\n4 5 7\n", {.up = up});
    SUCCEEDS(sut);
    CHECK((sut->cloud.points[0].cast<double>() - turn * Vec3(1, 2, 3)).norm() < 1e-6);
  }
}

// ---- meshes ----

TEST(ForeignCloud, MeshIsSampledWhateverItsFile) {
  const std::string vertices = "0 0 0\n300 0 0\n300 100 0\n0 100 0\n";
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  const double expected = 300 * 100 / (0.35 * 0.35);
  const auto is_sampled = [&](const char* name, const std::string& text, std::size_t left_out = 0) {
    const auto sut = read(name, text);
    CHECK_TEXT(sut.has_value(), (name + (sut ? std::string{} : to_line(sut.error()))).c_str());
    DOUBLES_EQUAL_TEXT(expected, sut->cloud.size(), 3, text.c_str());
    LONGS_EQUAL(left_out, sut->dropped);
  };
  is_sampled("a.ply", head + "element face 2\nproperty list uchar int vertex_indices\nend_header\n" +
                          vertices + "3 0 1 2\n3 0 2 3\n");
  is_sampled("b.ply",
             head +
                 "element face 1\nproperty list uchar uint vertex_index\nproperty uchar red\nend_header\n" +
                 vertices + "4 0 1 2 3 255\n");
  is_sampled("c.ply", head + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                          vertices + "5 1 2 0 3 -1\n");
  is_sampled("a.obj", "v 0 0 0\nv 300 0 0\nv 300 100 \\\n 0\nv 0 100 0\nf 1 2 \\\n 3 4\n");
  is_sampled("b.obj", "f 1 2 3\nf 1 3 4\nv 0 0 0\nv 300 0 0\nv 300 100 0\nv 0 100 0\nv nan nan nan\n");
  is_sampled("c.obj",
             "v 0 0 0\r\nv 300 0 0\r\nv 300 100 0\r\nv 0 100 0\r\nf -4//1 -3//1 -2//1 # a face\r\nf 1/ 3/2 "
             "4/2/2\r\n");
  is_sampled("d.obj", "v 0 0 0\nv 300 0 0\nv 300 100 0\nv 0 100 0\nv 1 nan 2\nf 1 2 3 4\nf 1 2 5\n", 1);
  const std::string facets =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 300 0 0\nvertex 300 100 0\nendloop\nendfacet\n"
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 300 100 0\nvertex 0 100 0\nendloop\nendfacet\n";
  is_sampled("a.stl", " solid a\n" + facets + "endsolid a\n");
  is_sampled("b.stl", "solid " + std::string(3000, 'n') + " facet vertex\n" + facets + "endsolid\n");
  is_sampled("c.stl",
             "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 300 0 0\nvertex 300 100 0\nvertex "
             "0 100 0\nendloop\nendfacet\nendsolid\n");
  is_sampled("d.stl", "solid one\n" + facets.substr(0, facets.size() / 2) + "endsolid one\nsolid two\n" +
                          facets.substr(facets.size() / 2) + "endsolid two\n");
  // In metres it is the same surface.
  const auto metres =
      read("m.obj", "v 0 0 0\nv 0.3 0 0\nv 0.3 0.1 0\nv 0 0.1 0\nf 1 2 3 4\n", {.unit = Unit::Metre});
  SUCCEEDS(metres);
  DOUBLES_EQUAL(expected, metres->cloud.size(), 3);
}

TEST(ForeignCloud, MeshInMetresIsToldItsUnit) {
  // Nothing of its surface is sampled in mm: its size is that of its vertices.
  const auto sut = read("m.obj", "v 0 0 0\nv 0.3 0 0\nv 0.3 0.1 0\nv 0 0.1 0\nf 1 2 3 4\n");
  SUCCEEDS(sut);
  const auto refusal = unit_refusal(*sut);
  CHECK(refusal.has_value());
  STRCMP_CONTAINS("in metres it would be 300 mm: give --unit m", refusal->reason.c_str());
}

TEST(ForeignCloud, CutMeshesAreRefused) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 300 0 0\nvertex 300 100 0\nendloop\nendfacet\n";
  FAILS_NAMING(Errc::Truncated, "endsolid expected", read("a.stl", "solid a\n" + facet));
  FAILS_NAMING(Errc::BadFormat, "three vertices in a loop",
               read("a.stl", "solid a\nouter loop\nvertex 0 0 0\nendloop\nendsolid\n"));
  FAILS_NAMING(Errc::BadValue, "row 3, z: a number expected, found '3x'",
               read("a.stl", "solid\nouter loop\nvertex 1 2 3x\n"));
  FAILS_NAMING(Errc::BadValue, "row 3, corner 3", read("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n"));
  FAILS_NAMING(Errc::BadValue, "row 2, corner 1", read("a.obj", "v 0 0 0\nf 0 1 1\n"));
}

TEST(ForeignCloud, PlyWithUnusualHead) {
  const std::string middle = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  for (const std::string& text : std::vector<std::string>{
           "PLY\nFORMAT ASCII 1.0\n" + middle + "END_HEADER\n1 2 3\n",
           "ply \nformat ascii 1.0\n" + middle + "end header\n1 2 3\n",
           "ply\nformat ascii 1.0\n" + middle + "property string name\nend_header\n1 2 3 heel\n",
           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float X\nproperty float Y\nproperty real "
           "Z\nend_header\n1 2 3\n"}) {
    const auto sut = read("a.ply", text);
    CHECK_TEXT(sut.has_value(), (text + (sut ? "" : to_line(sut.error()))).c_str());
    CHECK((sut->cloud.points[0] - Eigen::Vector3f(1, 2, 3)).norm() < 1e-6);
  }
  FAILS_NAMING(Errc::BadFormat, "a known property type",
               read("a.ply", "ply\nformat binary_little_endian 1.0\n" + middle +
                                 "property string name\nend_header\n123"));
}

// Small files made after public reports, where they are at hand.
TEST(ForeignCloud, FilesMadeAfterPublicReports) {
  BITELINE_SHARED_DATA_OR_SKIP(files, "../foreign");
  const auto is = [&](const char* name, std::size_t points, std::size_t left_out) {
    if (!std::filesystem::exists(files / name)) return;
    const auto sut = read_cloud_file(files / name);
    CHECK_TEXT(sut.has_value(), (name + (sut ? std::string{} : to_line(sut.error()))).c_str());
    LONGS_EQUAL_TEXT(points, sut->cloud.size(), name);
    LONGS_EQUAL_TEXT(left_out, sut->dropped, name);
  };
  for (const char* name :
       {"t1_tab_decimal_comma.txt", "t2_index_without_name.csv", "t3_normals_before_points.csv",
        "t4_bom_head.csv", "t4_sep_line.csv", "t4_head_then_count.txt", "t4_quoted_numbers.csv",
        "t4_decimal_comma_semicolon.csv", "n1_plus_signs.ply", "p1_int64.ply", "c1_no_points_line.pcd"}) {
    is(name, 8, 0);
    if (!std::filesystem::exists(files / name)) continue;
    const auto sut = read_cloud_file(files / name);
    DOUBLES_EQUAL_TEXT(10, sut->cloud.points.front().x(), 1e-6, name);
    DOUBLES_EQUAL_TEXT(70.25, sut->cloud.points.back().x(), 1e-6, name);
    DOUBLES_EQUAL_TEXT(9.5, sut->cloud.points.back().z(), 1e-6, name);
  }
  is("t2_height_empty.csv", 2, 2);
  is("n1_old_windows_nan.ply", 8, 1);
  is("u3_zeros_for_nothing.xyz", 682, 300);
  for (const char* name :
       {"m1_mesh_with_faces.ply", "o1_line_goes_on.obj", "s1_capitals.stl", "s1_leading_blank.stl"})
    is(name, 244898, 0);
  is("s2_one_triangle_without_numbers.stl", 244898, 1);
  const auto um = read_cloud_file(files / "u1_micrometres.xyz");
  SUCCEEDS(um);
  STRCMP_CONTAINS("--unit um", unit_refusal(*um)->reason.c_str());
  test::note_ran();
}

}  // namespace biteline::cloud
