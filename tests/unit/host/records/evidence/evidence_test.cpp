// SPDX-License-Identifier: MIT
#include "host/records/evidence/evidence.hpp"

#include <CppUTest/TestHarness.h>

#include "host/bite_line/edit/versions.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::evidence {

TEST_GROUP(Evidence) {
  test::TemporaryFolder folder;
  memory::Evidence written;

  void setup() override {
    for (const char* name : {"line.csv", "cloud.ply", "process.yaml", "report.json"})
      folder.write(name, std::string{"as the service wrote "} + name);
    written = now();
  }
  memory::Evidence now() const {
    const auto of = of_folder(folder.path());
    SUCCEEDS(of);
    return *of;
  }
  std::string told() const {
    return change(written, now()).value_or("");
  }
  std::string mended(int known = 0) const {
    return mended_since(folder.path(), written, now(), known).value_or("");
  }
};

TEST(Evidence, WhatIsAsItWasWrittenIsNotTold) {
  STRCMP_EQUAL("", told().c_str());
  // Written again with the same bytes it is the same.
  folder.write("line.csv", "as the service wrote line.csv");
  STRCMP_EQUAL("", told().c_str());
  // Of an older program nothing is known.
  written = {};
  folder.write("line.csv", "another");
  STRCMP_EQUAL("", told().c_str());
}

TEST(Evidence, EachFileThatIsAnotherOrGoneIsToldByItsName) {
  for (const char* name : {"line.csv", "cloud.ply", "process.yaml", "report.json"}) {
    folder.write(name, "another");
    STRCMP_CONTAINS((std::string{name} + " was changed since the service wrote it; ").c_str(),
                    told().c_str());
    std::filesystem::remove(folder.path() / name);
    STRCMP_CONTAINS((std::string{name} + " is gone").c_str(), told().c_str());
    folder.write(name, std::string{"as the service wrote "} + name);
    STRCMP_EQUAL("", told().c_str());
  }
}

TEST(Evidence, AFileThatCannotBeReadIsNoEvidence) {
  std::filesystem::remove(folder.path() / "line.csv");
  std::filesystem::create_directory(folder.path() / "line.csv");
  CHECK(!of_folder(folder.path()));
}

/// A mend keeps who and why, and the SHA-256 of what it wrote; a text editor does not.
TEST(Evidence, OnlyWhatAMendWroteIsANewerVersion) {
  cloud::ClosedLine line;
  for (const Vec3& position : {Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{0, 4, 0}})
    line.points.push_back(
        {.position = position, .normal = Vec3::UnitZ(), .tangent = Vec3::UnitX(), .confidence = 1});
  SUCCEEDS(cloud::write_line(folder.path() / "line.csv", line));
  written = now();
  line.points[0].position.z() = 1;
  const edit::Version made{
      .version = 0, .time = "now", .who = "ada", .why = "tried", .mended = 0, .steps = {}};
  SUCCEEDS(edit::save_version(folder.path(), made, line));
  // The version alone is not yet the line.
  STRCMP_EQUAL("", mended().c_str());
  SUCCEEDS(cloud::write_line(folder.path() / "line.csv", line));
  folder.write("report.json", "as the mend wrote it");
  STRCMP_CONTAINS("version 1 of the line, by ada", mended().c_str());
  // Known by now, or with another cloud, or edited behind it, it is none.
  STRCMP_EQUAL("", mended(1).c_str());
  folder.write("cloud.ply", "another");
  STRCMP_EQUAL("", mended().c_str());
  folder.write("cloud.ply", "as the service wrote cloud.ply");
  line.points[0].position.z() = 2;
  SUCCEEDS(cloud::write_line(folder.path() / "line.csv", line));
  STRCMP_EQUAL("", mended().c_str());
  STRCMP_CONTAINS("line.csv was changed", told().c_str());
  // Nor is a version whose own file was edited read any more.
  SUCCEEDS(edit::read_version(folder.path(), 1));
  SUCCEEDS(cloud::write_line(folder.path() / edit::line_file(1), line));
  const auto edited = edit::read_version(folder.path(), 1);
  CHECK(!edited);
  CHECK(edited.error().code == Errc::BadValue);
}

}  // namespace biteline::evidence
