// SPDX-License-Identifier: MIT
#include "host/bite_line/edit/versions.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>
#include <sstream>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::edit {

TEST_GROUP(MendVersions) {
  test::TemporaryFolder folder;
  cloud::ClosedLine line;

  void setup() override {
    for (const Vec3& place : {Vec3{0, 0, 1}, Vec3{1, 0, 1}, Vec3{1, 1, 1}})
      line.points.push_back(
          {.position = place, .normal = Vec3::UnitX(), .tangent = Vec3::UnitY(), .confidence = 0.5});
  }
  std::string text(const std::filesystem::path& file) const {
    std::ifstream stream(folder.path() / file);
    std::ostringstream all;
    all << stream.rdbuf();
    return all.str();
  }
  Version made(int mended) const {
    return {
        .version = 0,
        .time = "2026-11-21T02:00:00Z",
        .who = "ada",
        .why = "the heel",
        .mended = mended,
        .steps = {
            {.kind = Step::Kind::Through, .stretch = {.from_mm = 3, .to_mm = 9}, .points = {Vec3{1, 2, 3}}}}};
  }
};

TEST(MendVersions, WhatWasFoundIsKeptAndEveryMendIsAVersionWithWhoWhenAndWhy) {
  SUCCEEDS(cloud::write_line(folder.path() / "line.csv", line));
  folder.write("report.json", "{\"status\":\"ok\"}");
  const std::string found = text("line.csv");
  LONGS_EQUAL(1, read_versions(folder.path()).value().size());

  cloud::ClosedLine other = line;
  other.points[1].position.x() = 1.25;
  LONGS_EQUAL(1, save_version(folder.path(), made(0), other).value());
  STRCMP_EQUAL(found.c_str(), text(line_file(0)).c_str());
  STRCMP_EQUAL("{\"status\":\"ok\"}", text(found_report()).c_str());

  // What was found is not taken from what stands there later.
  SUCCEEDS(cloud::write_line(folder.path() / "line.csv", other));
  LONGS_EQUAL(2, save_version(folder.path(), made(1), line).value());
  STRCMP_EQUAL(found.c_str(), text(line_file(0)).c_str());

  const auto sut = read_versions(folder.path());
  SUCCEEDS(sut);
  LONGS_EQUAL(3, sut->size());
  STRCMP_EQUAL("ada", sut->at(2).who.c_str());
  STRCMP_EQUAL("the heel", sut->at(2).why.c_str());
  LONGS_EQUAL(1, sut->at(2).mended);
  STRCMP_EQUAL("through 1 points from 3.0 to 9.0 mm", words_of(sut->at(2).steps.at(0)).c_str());
  DOUBLES_EQUAL(1.25, read_version(folder.path(), 1).value().points[1].position.x(), 1e-9);
}

TEST(MendVersions, AMendOfAVersionThatIsNoMoreTheNewestIsRefused) {
  SUCCEEDS(cloud::write_line(folder.path() / "line.csv", line));
  SUCCEEDS(save_version(folder.path(), made(0), line));
  FAILS_NAMING(Errc::WrongState, "version 0 was mended, and the newest is 1",
               save_version(folder.path(), made(0), line));
  LONGS_EQUAL(2, read_versions(folder.path()).value().size());
}

TEST(MendVersions, ARefusedScanHasNoLineOfVersionNought) {
  folder.write("report.json", "{\"status\":\"refused\"}");
  CHECK_FALSE(read_version(folder.path(), 0).has_value());
  SUCCEEDS(save_version(folder.path(), made(0), line));
  CHECK_FALSE(read_version(folder.path(), 0).has_value());
  SUCCEEDS(read_version(folder.path(), 1));
}

TEST(MendVersions, ADamagedListIsToldByItsFile) {
  folder.write("lines/versions.json", "{\"versions\":[{\"version\":0}]}");
  FAILS_NAMING(Errc::BadFormat, "versions.json", read_versions(folder.path()));
  folder.write("lines/versions.json", R"({"versions":[{"version":3,"time":"","who":""}]})");
  FAILS_NAMING(Errc::BadValue, "version 0 expected, found 3", read_versions(folder.path()));
}

}  // namespace biteline::edit
