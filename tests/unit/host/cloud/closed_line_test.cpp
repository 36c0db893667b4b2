// SPDX-License-Identifier: MIT
#include "host/cloud/closed_line.hpp"

#include <CppUTest/TestHarness.h>

#include "common/csv/table.hpp"
#include "common/system/file.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::cloud {

TEST_GROUP(ClosedLine) {
  test::TemporaryFolder folder;
  ClosedLine square{
      .points = {{.position = {0, 0, 0}, .normal = {0, -1, 0}, .tangent = {1, 0, 0}, .confidence = 0.5},
                 {.position = {10, 0, 0}, .normal = {1, 0, 0}, .tangent = {0, 1, 0}, .confidence = 1},
                 {.position = {10, 10, 0}, .normal = {0, 1, 0}, .tangent = {-1, 0, 0}, .confidence = 0},
                 {.position = {0, 10, 0}, .normal = {-1, 0, 0}, .tangent = {0, -1, 0}, .confidence = 0.25}}};
};

TEST(ClosedLine, LengthGoesAllTheWayRound) {
  DOUBLES_EQUAL(40, length_mm(square), 1e-12);
}

TEST(ClosedLine, LineSurvivesWriting) {
  SUCCEEDS(write_line(folder.path() / "line.csv", square));
  const auto sut = read_line(folder.path() / "line.csv");
  SUCCEEDS(sut);
  LONGS_EQUAL(4, sut->points.size());
  for (std::size_t i = 0; i < 4; ++i) {
    DOUBLES_EQUAL(0, (square.points[i].position - sut->points[i].position).norm(), 1e-5);
    DOUBLES_EQUAL(0, (square.points[i].normal - sut->points[i].normal).norm(), 1e-6);
    DOUBLES_EQUAL(square.points[i].confidence, sut->points[i].confidence, 1e-4);
  }
}

TEST(ClosedLine, UncertaintyFlagsAndSourceSurviveWriting) {
  square.points[0].u95_mm = 0.125;
  square.points[1].source = PointSource::Carried;
  square.points[2].source = PointSource::Bridged;
  square.points[2].u95_mm = 1.5;
  square.points[2].flags = k_line_unsure;
  square.points[3].source = PointSource::Mended;
  SUCCEEDS(write_line(folder.path() / "line.csv", square));
  const auto sut = read_line(folder.path() / "line.csv");
  SUCCEEDS(sut);
  for (std::size_t i = 0; i < 4; ++i) {
    const LinePoint &expected = square.points[i], &found = sut->points[i];
    CHECK_EQUAL(expected.u95_mm.has_value(), found.u95_mm.has_value());
    if (expected.u95_mm) DOUBLES_EQUAL(*expected.u95_mm, *found.u95_mm, 1e-4);
    LONGS_EQUAL(expected.flags, found.flags);
    CHECK(expected.source == found.source);
  }
}

TEST(ClosedLine, ALineThatKnowsNoneOfThemIsWrittenWithoutThem) {
  SUCCEEDS(write_line(folder.path() / "line.csv", square));
  const auto text = read_regular_file(folder.path() / "line.csv", k_most_settings_bytes);
  SUCCEEDS(text);
  STRCMP_CONTAINS("confidence []\n", text->c_str());
  square.points[1].u95_mm = 0.2;
  SUCCEEDS(write_line(folder.path() / "line.csv", square));
  const auto more = read_regular_file(folder.path() / "line.csv", k_most_settings_bytes);
  SUCCEEDS(more);
  STRCMP_CONTAINS("confidence [],u95 [mm],flags [],source []\n", more->c_str());
}

TEST(ClosedLine, EachOfTheOptionalColumnsMayBeTheLast) {
  const std::string ten = "0,0,0,1,0,0,0,1,0,1";
  const auto sut = read_line(folder.write("a.csv", ten + "\n" + ten + ",0.3\n" + ten + ",,1\n"));
  SUCCEEDS(sut);
  CHECK_FALSE(sut->points[0].u95_mm.has_value());
  DOUBLES_EQUAL(0.3, *sut->points[1].u95_mm, 0);
  CHECK_FALSE(sut->points[2].u95_mm.has_value());
  LONGS_EQUAL(1, sut->points[2].flags);
}

TEST(ClosedLine, FaultsOfTheOptionalColumnsNameRowAndField) {
  const std::string ten = "0,0,0,1,0,0,0,1,0,1", good = ten + "\n";
  const auto with = [&](const std::string& rest) {
    return read_line(folder.write("a.csv", ten + rest + "\n" + good + good));
  };
  FAILS_NAMING(Errc::BadValue, "row 1, field 11: a U95 of 0 mm or more", with(",-0.1"));
  FAILS_NAMING(Errc::BadValue, "row 1, field 11: a finite number", with(",nan"));
  FAILS_NAMING(Errc::BadValue, "row 1, field 12: flags from 0", with(",0.1,-1"));
  FAILS_NAMING(Errc::BadValue, "row 1, field 12: flags from 0", with(",0.1,4294967296"));
  FAILS_NAMING(Errc::BadValue, "row 1, field 13: seen, bridged, carried or mended expected, found 'guessed'",
               with(",0.1,0,guessed"));
  FAILS_NAMING(Errc::BadFormat, "fields expected, found 14", with(",0.1,0,seen,1"));
}

TEST(ClosedLine, FaultsNameRowAndField) {
  const std::string good = "0,0,0,1,0,0,0,1,0,1\n";
  FAILS_NAMING(Errc::BadValue, "row 2, fields 4 to 6: a unit vector",
               read_line(folder.write("a.csv", good + "0,0,0,2,0,0,0,1,0,1\n" + good)));
  FAILS_NAMING(Errc::BadValue, "row 1, field 10: a confidence",
               read_line(folder.write("b.csv", "0,0,0,1,0,0,0,1,0,1.5\n" + good + good)));
  FAILS_NAMING(Errc::BadFormat, "at least 3 points", read_line(folder.write("c.csv", good + good)));
  FAILS_NAMING(Errc::BadFormat, "row 1: 10 fields expected, found 3",
               read_line(folder.write("d.csv", "1,2,3\n")));
}

TEST(ClosedLine, PositionsAreReadFromTheFirstThreeFields) {
  const auto sut = read_positions(folder.write("t.csv", "#x,y,z,d\n1,2,3,9\n4,5,6,9\n7,8,9,9\n"));
  SUCCEEDS(sut);
  DOUBLES_EQUAL(6, sut->points[1].position.z(), 0);
}

}  // namespace biteline::cloud
