// SPDX-License-Identifier: MIT
#include "host/cloud/cloud_file.hpp"

#include <CppUTest/TestHarness.h>
#include <liblzf/lzf.h>

#include <cmath>
#include <cstring>
#include <numeric>

#include "host/cloud/mesh_file.hpp"
#include "host/cloud/sample_surface.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/refusals.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::cloud {

TEST_GROUP(CloudFile) {
  test::TemporaryFolder folder;

  Result<CloudFile> read(const std::string& name, const std::string& text,
                         std::optional<Unit> unit = std::nullopt) {
    return read_cloud_file(folder.write(name, text), {.unit = unit});
  }
  void is_one_two_three(const Result<CloudFile>& sut, std::size_t points) {
    SUCCEEDS(sut);
    LONGS_EQUAL(points, sut->cloud.size());
    DOUBLES_EQUAL(0, (sut->cloud.points[0] - Eigen::Vector3f(1, 2, 3)).norm(), 1e-6);
  }
};

TEST(CloudFile, RowsOfNumbersWithAnySeparator) {
  for (const char* row : {"1 2 3\n4 5 6\n", "1,2,3\n4,5,6", "1;2;3\r\n4;5;6\r\n", "1\t2\t3\n4\t5\t6\n",
                          " 1.0, +2.0, 3e0 \n4,5,6\n"})
    is_one_two_three(read("c.xyz", row), 2);
}

TEST(CloudFile, HeadsCommentsAndCountsOfOtherPrograms) {
  is_one_two_three(read("a.csv", "x,y,z\n1,2,3\n"), 1);
  is_one_two_three(read("b.csv", "\"X [mm]\",\"Y [mm]\",\"Z [mm]\",R\n1,2,3,9\n"), 1);
  is_one_two_three(read("c.csv", "id,z,y,x\n7,3,2,1\n"), 1);
  is_one_two_three(read("d.txt", "//X,Y,Z,Scalar field\n1,2,3,0.5\n"), 1);
  is_one_two_three(read("e.csv", "Points_0,Points_1,Points_2\n1,2,3\n"), 1);
  is_one_two_three(read("f.pts", "2\n1 2 3 -100 12 13 14\n4 5 6 -100 1 1 1\n"), 2);
  is_one_two_three(read("g.asc", "# made by hand\n\n1 2 3\n# in between\n"), 1);
}

TEST(CloudFile, FaultsNameRowAndField) {
  FAILS_NAMING(Errc::BadValue, "c.xyz row 2, field 3", read("c.xyz", "1 2 3\n1 2 x3\n"));
  FAILS_NAMING(Errc::BadFormat, "row 3: 3 numbers expected, as in the rows before, found 2",
               read("c.xyz", "1 2 3\n1 2 3\n1 2\n"));
  FAILS_NAMING(Errc::BadValue, "no point", read("c.xyz", "# nothing\n"));
  FAILS_NAMING(Errc::BadFormat, ".ply .xyz", read("c.docx", "1 2 3\n"));
}

TEST(CloudFile, WhatIsNotFiniteOrFarIsLeftOutAndCounted) {
  const auto sut = read("c.xyz", "1 2 3\nnan 2 3\n1 inf 3\n1 2 1e9\n1 2 1e999\n");
  is_one_two_three(sut, 1);
  LONGS_EQUAL(4, sut->dropped);
}

TEST(CloudFile, UnitsBecomeMillimetres) {
  const auto metres = read("c.xyz", "0.001 0.002 0.003\n", Unit::Metre);
  is_one_two_three(metres, 1);
  const auto inches = read("c.xyz", "1 2 3\n", Unit::Inch);
  SUCCEEDS(inches);
  DOUBLES_EQUAL(0, (inches->cloud.points[0] - Eigen::Vector3f(25.4F, 50.8F, 76.2F)).norm(), 1e-4);
  is_one_two_three(read("c.xyz", "0.1 0.2 0.3\n", Unit::Centimetre), 1);
  is_one_two_three(read("c.xyz", "1000 2000 3000\n", Unit::Micrometre), 1);
}

TEST(CloudFile, SizeThatFitsAnotherUnitIsToldWhereNobodyGaveOne) {
  const struct {
    double size_mm;
    const char* advice;
    const char* told;
  } k_cases[]{{0.28, "--unit m", "the cloud is 0.28 mm long"},
              {29.4, "--unit cm", "is 29.4 mm long"},
              {11.6, "--unit in", "is 11.6 mm long"},
              {280'000, "--unit um", "is 280 000 mm long"},
              {1.2, "--unit m", "is 1.2 mm long"}};
  for (const auto& one : k_cases) {
    CloudFile file;
    file.size_mm = one.size_mm;
    const auto refusal = unit_refusal(file);
    CHECK(refusal.has_value());
    STRCMP_CONTAINS(one.advice, refusal->reason.c_str());
    STRCMP_CONTAINS(one.told, refusal->reason.c_str());
    file.unit = Unit::Millimetre;
    CHECK(!unit_refusal(file).has_value());
  }
  // A shoe, and what no unit makes one: judged as it is.
  for (const double size_mm : {280.0, 60.0, 1500.0, 0.0, 0.001, 5'000.0, 1e9}) {
    CloudFile file;
    file.size_mm = size_mm;
    CHECK(!unit_refusal(file).has_value());
  }
  test::check_refusal_table(UnitRefused::OtherUnit);
}

// ---- PCD ----

namespace {

const char* const k_pcd_head =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS rgb x y z\nSIZE 4 4 8 2\nTYPE U F F I\nCOUNT 2 1 1 1\nWIDTH 2\nHEIGHT "
    "1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Two points, 22 bytes each: rgb twice, then x as float, y as double, z as a 16-bit number.
std::string pcd_rows() {
  std::string bytes;
  for (int i = 0; i < 2; ++i) {
    put(bytes, std::uint32_t{7});
    put(bytes, std::uint32_t{8});
    put(bytes, static_cast<float>(1 + 3 * i));
    put(bytes, static_cast<double>(2 + 3 * i));
    put(bytes, static_cast<std::int16_t>(3 + 3 * i));
  }
  return bytes;
}

/// The same, field after field.
std::string pcd_columns() {
  const std::string rows = pcd_rows();
  std::string bytes;
  std::size_t at = 0;
  for (const std::size_t size : {8, 4, 8, 2}) {
    for (std::size_t i = 0; i < 2; ++i) bytes += rows.substr(22 * i + at, size);
    at += size;
  }
  return bytes;
}

std::string packed(const std::string& bytes) {
  std::string out(bytes.size() + 64, '\0');
  const unsigned size = lzf_compress(bytes.data(), static_cast<unsigned>(bytes.size()), out.data(),
                                     static_cast<unsigned>(out.size()));
  CHECK(size > 0);
  std::string whole;
  put(whole, static_cast<std::uint32_t>(size));
  put(whole, static_cast<std::uint32_t>(bytes.size()));
  return whole + out.substr(0, size);
}

}  // namespace

TEST(CloudFile, PcdInAllThreeKinds) {
  const std::string head = k_pcd_head;
  is_one_two_three(read("a.pcd", head + "ascii\n7 8 1 2 3\n7 8 4 5 6\n"), 2);
  is_one_two_three(read("b.pcd", head + "binary\n" + pcd_rows()), 2);
  is_one_two_three(read("c.pcd", head + "binary_compressed\n" + packed(pcd_columns())), 2);
  DOUBLES_EQUAL(6, read("c.pcd", head + "binary_compressed\n" + packed(pcd_columns()))->cloud.points[1].z(),
                1e-6);
}

TEST(CloudFile, DamagedPcdSaysWhatIsMissing) {
  const std::string head = k_pcd_head;
  FAILS_NAMING(Errc::Truncated, "44 bytes of points expected, found 40",
               read("a.pcd", head + "binary\n" + pcd_rows().substr(0, 40)));
  FAILS_NAMING(Errc::Truncated, "row 13: 5 numbers expected, found 0",
               read("a.pcd", head + "ascii\n7 8 1 2 3\n"));
  std::string damaged = packed(pcd_columns());
  damaged.resize(damaged.size() - 4);
  FAILS_NAMING(Errc::Truncated, "packed bytes", read("a.pcd", head + "binary_compressed\n" + damaged));
  FAILS_NAMING(Errc::BadFormat, "one y expected",
               read("a.pcd", "FIELDS x z\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nPOINTS 1\nDATA ascii\n1 2\n"));
  FAILS_NAMING(
      Errc::BadFormat, "POINTS",
      read("a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 99999999999\nDATA ascii\n1 2 3\n"));
  FAILS_NAMING(Errc::BadFormat, "DATA", read("a.pcd", "FIELDS x y z\nPOINTS 1\n"));
}

// ---- meshes ----

TEST(CloudFile, StlAsTextAndBinaryGiveTheSameMesh) {
  const std::string text =
      "solid shoe\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 10 0 0\n"
      "vertex 0 10 0\nendloop\nendfacet\nendsolid\n";
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");  // as some programs write it
  put(bytes, std::uint32_t{1});
  for (const float value : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 10.F, 0.F, 0.F, 0.F, 10.F, 0.F}) put(bytes, value);
  put(bytes, std::uint16_t{0});
  const auto a = read_stl(text, "a.stl"), b = read_stl(bytes, "b.stl");
  SUCCEEDS(a);
  SUCCEEDS(b);
  CHECK(a->places == b->places);
  CHECK(a->faces == b->faces);
  FAILS_NAMING(Errc::Truncated, "1 triangles expected, found 0", read_stl(bytes.substr(0, 100), "c.stl"));
}

TEST(CloudFile, ObjTakesPolygonsAndNumbersFromTheEnd) {
  const auto sut = read_obj(
      "mtllib a.mtl\nv 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nvt 0 0\nf 1/1 2/1 3/1 4/1\nf -4 -3 -2\n",
      "a.obj");
  SUCCEEDS(sut);
  LONGS_EQUAL(4, sut->places.size());
  LONGS_EQUAL(3, sut->faces.size());
  CHECK(sut->faces[1] == (std::array<std::uint32_t, 3>{0, 2, 3}));
  FAILS_NAMING(Errc::BadValue, "row 2, corner 1", read_obj("v 0 0 0\nf 2 1 1\n", "b.obj"));
  FAILS_NAMING(Errc::BadValue, "row 1, y", read_obj("v 0 1x 0\n", "c.obj"));
  LONGS_EQUAL(1, read("d.obj", "v 1 2 3\n")->cloud.size());
}

TEST(CloudFile, SampledSurfaceIsEvenAndAsDenseAsAsked) {
  // A square of 20 mm, cut into one large triangle and many slivers.
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {20, 0, 0}, {0, 20, 0}};
  mesh.faces = {{0, 1, 2}};
  constexpr int k_slivers = 200;
  for (int i = 0; i <= k_slivers; ++i) {
    const float t = static_cast<float>(i) / k_slivers;
    mesh.vertices.emplace_back(20 * (1 - t), 20 * t, 0.F);
  }
  mesh.vertices.emplace_back(20.F, 20.F, 0.F);
  for (std::uint32_t i = 0; i < k_slivers; ++i) mesh.faces.push_back({3 + i, k_slivers + 4, 4 + i});
  const auto sut = sample_surface(mesh, 0.5);
  SUCCEEDS(sut);
  DOUBLES_EQUAL(20 * 20 / 0.25, sut->size(), 1);
  // Each square of 2.5 mm holds 25 points, give or take the border's: 4 sides of 5 points.
  std::array<int, 64> count{};
  for (const Eigen::Vector3f& p : *sut) {
    ++count[static_cast<std::size_t>(std::min(7.F, p.x() / 2.5F)) +
            8 * static_cast<std::size_t>(std::min(7.F, p.y() / 2.5F))];
  }
  for (const int in_square : count) CHECK(in_square >= 15 && in_square <= 35);
  CHECK(!sample_surface(mesh, 1e-4).has_value());
}

}  // namespace biteline::cloud
