// SPDX-License-Identifier: MIT
#include "host/cloud/ply.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::cloud {

TEST_GROUP(Ply) {
  test::TemporaryFolder folder;

  Result<PointCloud> read(const std::string& text) {
    return read_cloud(folder.write("c.ply", text));
  }
};

TEST(Ply, CloudSurvivesWriting) {
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) {
    cloud.points.push_back({static_cast<float>(i) * 0.1F, 500.25F, -3});
    cloud.normals.push_back(Eigen::Vector3f(1, static_cast<float>(i), 0).normalized());
    cloud.profile.push_back(static_cast<std::uint32_t>(100'000 + i));
    cloud.column.push_back(static_cast<std::uint16_t>(1600 + i));
    cloud.sigma_mm.push_back(0.01F);
    cloud.flags.push_back(3);
    cloud.mean_per_mm.push_back(i == 7 ? std::numeric_limits<float>::quiet_NaN()
                                       : 0.01F * static_cast<float>(i));
    cloud.amplitude.push_back(i == 5 ? 0.F : 100.5F + static_cast<float>(i));
    cloud.width_px.push_back(4.25F);
  }
  SUCCEEDS(write_cloud(folder.path() / "c.ply", cloud));
  const auto sut = read_cloud(folder.path() / "c.ply");
  SUCCEEDS(sut);
  CHECK(cloud.points == sut->points);
  CHECK(cloud.profile == sut->profile);
  CHECK(cloud.column == sut->column);
  CHECK(cloud.flags == sut->flags);
  CHECK(cloud.sigma_mm == sut->sigma_mm);
  DOUBLES_EQUAL(0, (cloud.normals[7] - sut->normals[7]).norm(), 1e-6);
  DOUBLES_EQUAL(0.08, sut->mean_per_mm[8], 1e-6);
  CHECK(std::isnan(sut->mean_per_mm[7]));
  CHECK(cloud.amplitude == sut->amplitude);
  CHECK(cloud.width_px == sut->width_px);
}

TEST(Ply, AnAmplitudeThatIsNoneIsNotKnown) {
  const auto sut = read(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float amplitude\nproperty float width_px\nend_header\n1 2 3 nan -4\n4 5 6 120 nan\n7 8 9 "
      "1e300 5\n");
  SUCCEEDS(sut);
  CHECK((sut->amplitude == std::vector<float>{0, 120, 0}));
  CHECK((sut->width_px == std::vector<float>{0, 0, 5}));
}

TEST(Ply, CloudWithoutStripeIsWrittenWithout) {
  const PointCloud cloud{.points = {{1, 2, 3}}};
  SUCCEEDS(write_cloud(folder.path() / "c.ply", cloud));
  const auto sut = read_cloud(folder.path() / "c.ply");
  SUCCEEDS(sut);
  CHECK(sut->amplitude.empty());
  CHECK(sut->width_px.empty());
}

TEST(Ply, ElementWithoutPropertiesCostsNothingHoweverManyRowsItClaims) {
  const std::string before = "element nothing 1000000000000000000\n";
  const auto sut =
      read("ply\nformat ascii 1.0\n" + before +
           "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n");
  SUCCEEDS(sut);
  LONGS_EQUAL(1, sut->size());
  const std::string faces =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1000000000000000000\nend_header\n1 2 3\n4 5 6\n7 8 9\n";
  FAILS_NAMING(Errc::BadFormat, "at least one triangle", read_mesh(folder.write("m.ply", faces)));
}

TEST(Ply, UnknownTypesAreRefusedInABinaryFileWhereverItsFormatLineIs) {
  const std::string places = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string unknown = "element other 2\nproperty word a\n",
                    binary = "format binary_little_endian 1.0\n";
  const std::string body = "end_header\n" + std::string(40, '\0');
  FAILS_NAMING(Errc::BadFormat, "a known property type", read("ply\n" + binary + places + unknown + body));
  FAILS_NAMING(Errc::BadFormat, "known property types in a binary file",
               read("ply\n" + places + unknown + binary + body));
  FAILS_NAMING(Errc::BadFormat, "only one format line",
               read("ply\nformat ascii 1.0\n" + places + unknown + binary + body));
}

TEST(Ply, SecondElementVertexIsRefused) {
  const std::string two =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element vertex 1\nproperty float y\nend_header\n1 2 3\n4\n";
  FAILS_NAMING(Errc::BadFormat, "only one element vertex", read_mesh(folder.write("m.ply", two)));
  FAILS_NAMING(Errc::BadFormat, "only one element vertex", read(two));
}

TEST(Ply, FarPointsAndTrianglesWithFarCornersAreLeftOut) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n";
  std::size_t dropped = 0;
  const auto sut =
      read_cloud(folder.write("c.ply", head + "end_header\n1e39 2 3\n1 2 3\n1 -1e6 3\n"), &dropped);
  SUCCEEDS(sut);
  LONGS_EQUAL(1, sut->size());
  LONGS_EQUAL(2, dropped);
  FAILS_NAMING(Errc::BadValue, "no point with finite numbers below 100 m",
               read(head + "end_header\n1e39 2 3\n1e39 2 3\n1e9 2 3\n"));
  FAILS_NAMING(Errc::BadFormat, "at least one triangle",
               read_mesh(folder.write(
                   "m.ply", head + "element face 1\nproperty list uchar int vertex_index\nend_header\n"
                                   "1 2 3\n1e38 2 3\n1 1 3\n3 0 1 2\n")));
}

TEST(Ply, CountThatNoBodyBacksEndsWithTheFile) {
  for (const char* element :
       {"element vertex 1000000000000000000\n", "element vertex 18446744073709551615\n"}) {
    const auto sut = read(std::string{"ply\nformat binary_little_endian 1.0\n"} + element +
                          "property float x\nproperty float y\nproperty float z\nend_header\n0123456789");
    FAILS_NAMING(Errc::Truncated, "more values expected", sut);
  }
}

TEST(Ply, WordsOfTheFileReachTheTerminalClean) {
  FAILS_NAMING(
      Errc::BadFormat, "found '?[31mred?'",
      read("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
           "end_header\n\x1b[31mred\x07 2 3\n"));
}

TEST(Ply, AsciiWithForeignPropertiesAndElementsIsRead) {
  const auto sut = read(
      "ply\nformat ascii 1.0\ncomment made\nelement camera 1\nproperty list uchar int views\nelement vertex "
      "2\n"
      "property uchar red\nproperty double z\nproperty double y\nproperty double x\nend_header\n2 5 6\n9 3 2 "
      "1\n9 6 5 4\n");
  SUCCEEDS(sut);
  LONGS_EQUAL(2, sut->size());
  DOUBLES_EQUAL(4, sut->points[1].x(), 0);
  DOUBLES_EQUAL(6, sut->points[1].z(), 0);
  CHECK(!sut->organised());
}

TEST(Ply, BigEndianIsRead) {
  std::string text =
      "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
      "short z\nend_header\n";
  text += std::string("\x3f\x80\x00\x00\xc0\x00\x00\x00\xff\xfe", 10);
  const auto sut = read(text);
  SUCCEEDS(sut);
  DOUBLES_EQUAL(1, sut->points[0].x(), 0);
  DOUBLES_EQUAL(-2, sut->points[0].y(), 0);
  DOUBLES_EQUAL(-2, sut->points[0].z(), 0);
}

TEST(Ply, PointsThatAreNotFiniteAreLeftOutAndCounted) {
  std::size_t dropped = 0;
  const auto sut =
      read_cloud(folder.write("n.ply",
                              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                              "property float z\nend_header\n1 2 3\nnan 2 3\n4 5 inf\n"),
                 &dropped);
  SUCCEEDS(sut);
  LONGS_EQUAL(1, sut->size());
  LONGS_EQUAL(2, dropped);
}

TEST(Ply, FaultsNameThePlace) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n";
  FAILS_NAMING(Errc::Truncated, "line 9: more values expected", read(head + "1 2 3\n"));
  FAILS_NAMING(Errc::BadFormat, "line 8: more fields expected", read(head + "1 2\n3 4 5\n"));
  FAILS_NAMING(Errc::BadFormat, "line 8: fewer fields expected", read(head + "1 2 3 4\n3 4 5\n"));
  FAILS_NAMING(Errc::BadFormat, "line 9: a number expected, found 'x3'", read(head + "1 2 3\nx3 4 5\n"));
  FAILS_NAMING(
      Errc::BadFormat, "property x expected",
      read("ply\nformat ascii 1.0\nelement vertex 1\nproperty float y\nproperty float z\nend_header\n1 2\n"));
  FAILS_NAMING(Errc::BadFormat, "at least one point expected",
               read("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty "
                    "float z\nend_header\n"));
  FAILS_NAMING(Errc::BadFormat, "a PLY file expected", read("solid\nnot a ply\n"));
  FAILS_NAMING(Errc::Truncated, "end_header expected", read("ply\nformat ascii 1.0\n"));
}

TEST(Ply, HugeCountInADamagedHeaderAsksForNoMemory) {
  FAILS_NAMING(Errc::Truncated, "more values expected",
               read("ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\nproperty "
                    "float x\nproperty float y\n"
                    "property float z\nend_header\n1234"));
}

TEST(Ply, BinaryCutAnywhereIsRefusedNotOverrun) {
  PointCloud cloud;
  cloud.points.assign(5, {1, 2, 3});
  SUCCEEDS(write_cloud(folder.path() / "w.ply", cloud));
  std::ifstream file(folder.path() / "w.ply", std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  for (std::size_t kept = 0; kept < bytes.str().size(); ++kept) CHECK(!read(bytes.str().substr(0, kept)));
}

TEST(Ply, BinaryMeshIsRead) {
  const std::array<float, 9> vertices{0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n";
  text.append(reinterpret_cast<const char*>(vertices.data()), sizeof vertices);
  text += std::string{"\3\0\0\0\0\1\0\0\0\2\0\0\0", 13};
  const auto sut = read_mesh(folder.write("m.ply", text));
  SUCCEEDS(sut);
  LONGS_EQUAL(1, sut->faces.size());
  CHECK((sut->faces[0] == std::array<std::uint32_t, 3>{0, 1, 2}));
  DOUBLES_EQUAL(1, static_cast<double>(sut->vertices[2].y()), 0);
}

/// Its faces are numbered anew then, and must still name the same places.
TEST(Ply, AVertexThatNoFaceUsesMovesNoOther) {
  const auto sut = read_mesh(folder.write(
      "u.ply",
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "9 9 9\n1 0 0\n8 8 8\n2 0 0\n2 3 0\n3 1 3 4\n"));
  SUCCEEDS(sut);
  LONGS_EQUAL(1, sut->faces.size());
  const Eigen::Vector3f expected[] = {{1, 0, 0}, {2, 0, 0}, {2, 3, 0}};
  for (std::size_t i = 0; i < 3; ++i) CHECK(sut->vertices[sut->faces[0][i]] == expected[i]);
}

TEST(Ply, PolygonsAreCutIntoFans) {
  const auto quad = read_mesh(folder.write(
      "q.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 "
      "2 3\n"));
  SUCCEEDS(quad);
  LONGS_EQUAL(2, quad->faces.size());
  CHECK((quad->faces[0] == std::array<std::uint32_t, 3>{0, 1, 2}));
  CHECK((quad->faces[1] == std::array<std::uint32_t, 3>{0, 2, 3}));
}

TEST(Ply, FaceWithAVertexThatIsNotThereIsRefused) {
  FAILS_NAMING(
      Errc::BadValue, "face 0: a vertex number below 1 expected",
      read_mesh(folder.write(
          "b.ply",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 1 2\n")));
}

}  // namespace biteline::cloud
