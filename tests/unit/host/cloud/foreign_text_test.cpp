// SPDX-License-Identifier: MIT
// Text clouds of other people's programs: heads, separators, numbers, names, and what is no list of points.
#include <CppUTest/TestHarness.h>

#include "host/cloud/cloud_file.hpp"
#include "host/cloud/column_names.hpp"
#include "host/cloud/written_number.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::cloud {

TEST_GROUP(ForeignText) {
  test::TemporaryFolder folder;

  Result<CloudFile> read(const std::string& text, const Reading& reading = {}) const {
    return read_cloud_file(folder.write("a.csv", text), reading);
  }
  /// Two points, 1.5 2.25 3 and 4 5 6.5, whatever stands about them.
  void two_points(const std::string& text, std::size_t left_out = 0) const {
    const auto sut = read(text);
    CHECK_TEXT(sut.has_value(), (text + (sut ? "" : to_line(sut.error()))).c_str());
    LONGS_EQUAL_TEXT(2, sut->cloud.size(), text.c_str());
    LONGS_EQUAL_TEXT(left_out, sut->dropped, text.c_str());
    const bool same = sut->cloud.points[0].isApprox(Eigen::Vector3f(1.5F, 2.25F, 3.F)) &&
                      sut->cloud.points[1].isApprox(Eigen::Vector3f(4.F, 5.F, 6.5F));
    CHECK_TEXT(same, (text + sut->understood).c_str());
  }
  void says(const char* words, const std::string& text, const Reading& reading = {}) const {
    const auto sut = read(text, reading);
    CHECK_TEXT(!sut.has_value(), text.c_str());
    STRCMP_CONTAINS(words, to_line(sut.error()).c_str());
  }
};

TEST(ForeignText, DecimalCommas) {
  two_points("1,5\t2,25\t3\n4\t5\t6,5\n");
  two_points("1,5;2,25;3,0\n4,0;5,0;6,5\n");
  two_points("1,5 2,25 3,0\n4,0 5,0 6,5\n");
  two_points("1,5 \t 2,25\t3,0\n4,0\t 5,0 \t6,5\n");
  two_points("\"1,5\",\"2,25\",\"3,0\"\n\"4,0\",\"5,0\",\"6,5\"\n");
  two_points("1,5|2,25|3\n4|5|6,5\n");
  two_points("1,5E+00;2,25;+3,0D0\n4;5;6,5\n");
}

TEST(ForeignText, HeadsOfAllKinds) {
  two_points("\xEF\xBB\xBFx,y,z\n1.5,2.25,3\n4,5,6.5\n");
  two_points("sep=;\nx;y;z\n1.5;2.25;3\n4;5;6.5\n");
  two_points("//X;Y;Z;R\n2\n1.5;2.25;3;1\n4;5;6.5;1\n");
  two_points("2\nx y z\n1.5 2.25 3\n4 5 6.5\n");
  two_points("scanner 7, shoe 12\nmade on Friday\n\nx,y,z\n1.5,2.25,3\n4,5,6.5\n");
  two_points("# x y z nx ny nz\n1.5 2.25 3 0 0 1\n4 5 6.5 0 0 1\n");
  two_points("# nx ny nz x y z\n0 0 1 1.5 2.25 3\n0 0 1 4 5 6.5\n");
  two_points("X;Y;Z\nmm;mm;mm\n1.5;2.25;3\n4;5;6.5\n");
  two_points("x,y,z,\n1.5,2.25,3,\n4,5,6.5,\n");
  two_points("Z,Y,X\n3,2.25,1.5\n6.5,5,4\n");
  two_points("name,x,y,z\nP1,1.5,2.25,3\nP2,4,5,6.5\n");
}

TEST(ForeignText, IndexColumnsAndPixelColumnsAreNoPlaces) {
  two_points(",x,y,z\n0,1.5,2.25,3\n1,4,5,6.5\n");
  two_points("\"\",\"x\",\"y\",\"z\"\n\"1\",1.5,2.25,3\n\"2\",4,5,6.5\n");
  two_points("\"x\" \"y\" \"z\"\n\"1\" 1.5 2.25 3\n\"2\" 4 5 6.5\n");
  two_points("0,1,2\n1.5,2.25,3.0\n4.0,5.0,6.5\n");
  two_points(",0,1,2\n0,1.5,2.25,3.0\n1,4.0,5.0,6.5\n");
  two_points("x_index,y_index,x,y,z\n7,8,1.5,2.25,3\n9,9,4,5,6.5\n");
  two_points(
      "\"Normals:0\",\"Normals:1\",\"Normals:2\",\"Points:0\",\"Points:1\",\"Points:2\"\n"
      "0,0,1,1.5,2.25,3\n0,0,1,4,5,6.5\n");
  two_points("px,py,pos_x,pos_y,pos_z\n7,8,1.5,2.25,3\n9,9,4,5,6.5\n");
  // A row's number without a head, from first to last; a grid's column counts up, and begins anew.
  two_points("1 1.5 2.25 3.0\n2 4.0 5.0 6.5\n");
  const auto grid = read("0 0 5.5 9\n1 0 5.5 9\n2 0 5.5 9\n0 1 5.5 9\n1 1 5.5 9\n2 1 5.5 9\n");
  SUCCEEDS(grid);
  DOUBLES_EQUAL(2, grid->cloud.points[2].x(), 0);
}

TEST(ForeignText, NamesThatAreAPlace) {
  const auto is = [](std::vector<std::string_view> names, std::array<std::size_t, 3> expected) {
    const auto found = named_columns(names);
    CHECK_TEXT(found.has_value(), std::string(names[0]).c_str());
    CHECK_TEXT(found->field == expected, std::string(names[0]).c_str());
  };
  is({"x", "y", "z"}, {0, 1, 2});
  is({"//X", "Y", "Z", "R"}, {0, 1, 2});
  is({"\"X [mm]\"", "Y / mm", "Z in mm"}, {0, 1, 2});
  is({"x_um", "y_um", "z_um"}, {0, 1, 2});
  is({"posX", "posY", "posZ"}, {0, 1, 2});
  is({"CoordX", "CoordY", "CoordZ"}, {0, 1, 2});
  is({"X-Koordinate", "Y-Koordinate", "Z-Koordinate"}, {0, 1, 2});
  is({"Points_0", "Points_1", "Points_2", "Points_Magnitude"}, {0, 1, 2});
  is({"position.x", "position.y", "position.z"}, {0, 1, 2});
  is({"x", "nx", "ny", "nz", "y", "z"}, {0, 4, 5});
  is({"normal_x", "normal_y", "normal_z", "x", "y", "z"}, {3, 4, 5});
  for (const std::vector<std::string_view>& none : {std::vector<std::string_view>{"nx", "ny", "nz"},
                                                    {"vx", "vy", "vz"},
                                                    {"x_index", "y_index", "z_index"},
                                                    {"Normals:0", "Normals:1", "Normals:2"},
                                                    {"x_err", "y_err", "z_err"},
                                                    {"x", "y", "height"},
                                                    {"x_px", "y_px", "z_px"},
                                                    {"rgb_0", "rgb_1", "rgb_2"},
                                                    {"xx", "yy", "zz"},
                                                    {"x y", "y z", "z x"}})
    CHECK_TEXT(!named_columns(none).has_value(), std::string(none[0]).c_str());
}

TEST(ForeignText, CellsWithoutNumberAreLeftOutAndCounted) {
  two_points("x,y,z,i\n1.5,2.25,3,120\n30,5.5,,31\n4,5,6.5,118\n70,6.5,,29\n", 2);
  for (const char* nothing : {"nan", "NaN", "-nan(ind)", "1.#QNAN", "-1.#IND00", "inf", "-Infinity", "null",
                              "-", "n/a", "#DIV/0!", "****", "NA", "", "1e999"})
    two_points(std::string{"1.5;2.25;3\n7.5;8.5;"} + nothing + "\n4;5;6.5\n", 1);
  two_points("1.5 2.25 3\n- - -\n4 5 6.5\nEND\n", 2);
}

TEST(ForeignText, NumbersOfOtherWriters) {
  const auto is = [](const char* text, double expected, char decimal = '.') {
    double value = -77;
    LONGS_EQUAL_TEXT(static_cast<int>(Written::Number),
                     static_cast<int>(written_number(text, decimal, value)), text);
    DOUBLES_EQUAL_TEXT(expected, value, 1e-12 * std::abs(expected), text);
  };
  is("+1.5", 1.5), is("1.0D+01", 10), is("1.0d-02", 0.01), is("-.5", -0.5), is("5.", 5), is(" 7 ", 7);
  is("0.25-101", 0.25e-101), is("1.5+100", 1.5e100), is("\"3.5\"", 3.5), is("1e-999", 0),
      is("\xE2\x88\x92"
         "2.5",
         -2.5);
  is("1,5", 1.5, ','), is("1,5E+2", 150, ','), is("-3", -3, ',');
  for (const char* wrong :
       {"1.2.3", "1'234", "x3", "1,5", "12mm", "2026-11-27", "10:30", "1e", "--5", "+-5", "12-5"}) {
    double value = 0;
    LONGS_EQUAL_TEXT(static_cast<int>(Written::Wrong), static_cast<int>(written_number(wrong, '.', value)),
                     wrong);
  }
}

TEST(ForeignText, UnitsInTheHead) {
  const auto um = read("x_um,y_um,z_um\n1500,2250,3000\n");
  SUCCEEDS(um);
  CHECK(um->cloud.points[0].isApprox(Eigen::Vector3f(1.5F, 2.25F, 3.F)));
  CHECK(um->unit == Unit::Micrometre);
  const auto mixed = read("X [mm];Y [mm];Z [\xC2\xB5m]\n1.5;2.25;3000\n");
  SUCCEEDS(mixed);
  CHECK(mixed->cloud.points[0].isApprox(Eigen::Vector3f(1.5F, 2.25F, 3.F)));
  const auto metres = read("x (m),y (m),z (m)\n0.0015,0.00225,0.003\n", {.unit = Unit::Metre});
  SUCCEEDS(metres);
  CHECK(metres->cloud.points[0].isApprox(Eigen::Vector3f(1.5F, 2.25F, 3.F)));
  says("says x is in um, and --unit says mm", "x_um,y_um,z_um\n1,2,3\n", {.unit = Unit::Millimetre});
}

TEST(ForeignText, WhatIsNoListOfPointsIsRefusedByItsName) {
  std::string grid;
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 200; ++column) grid += "12.5,";
    grid += "12.5\n";
  }
  says("a grid of heights, 201 a row", grid);
  says("a grid of heights", "ncols 4\nnrows 2\ncellsize 0.5\n1 2 3 4\n5 6 7 8\n");
  says("columns named x, y and z expected, found 'a,b,c,d'", "a,b,c,d\n1,2,3,4\n5,6,7,8\n");
  says("columns named x, y and z expected", "nx,ny,nz,i\n0,0,1,5\n0,0,1,6\n");
  says("x y z expected, three numbers a row; found '4 5'", "1 2\n4 5\n");
  says("a decimal comma?", "x,y,z\n1,5,2,25,3,0\n4,0,5,0,6,5\n");
  says("an Excel file", std::string("PK\x03\x04\0\0", 6));
  says("binary data", std::string("\x01\0\x02\xFF\0\0\0", 7));
  says("PTX",
       "2\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1.5 2 3 0.5\n4 5 6 0.5\n1 2 3 "
       "1\n");
  says("no point", "");
  says("no point", "# nothing\n");
  says("3 points expected, as the file itself says, found 2", "3\n1 2 3\n4 5 6\n");
}

TEST(ForeignText, OneLineSaysHowItWasUnderstood) {
  const auto sut = read("n;x;y;z;i;j;k\n1;1,5;2,5;3,5;0;0;0\n2;4,5;5,5;;0;0;0\n");
  SUCCEEDS(sut);
  STRCMP_EQUAL("1 points, columns 2 to 4 of 7, semicolons, decimal comma; 1 left out: no number",
               sut->understood.c_str());
}

}  // namespace biteline::cloud
