// SPDX-License-Identifier: MIT
// The same points by many programs' habits: read as they are, or refused in one true sentence.
#include <CppUTest/TestHarness.h>

#include <functional>
#include <random>

#include "host/cloud/cloud_file.hpp"
#include "host/cloud/mesh_file.hpp"
#include "host/cloud/ply_file.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/cloud/cloud_writers.hpp"

namespace biteline::cloud {
namespace {

constexpr std::uint32_t k_files_each = 20;  // 300 in all
/// Floats of some 100 mm, and the writers' own digits.
constexpr double k_same_mm = 2e-5;

/// Empty: the points are those written, as far as they go; `spoiled_end`: but for the last one.
std::string difference(const std::vector<Eigen::Vector3d>& expected,
                       const std::vector<Eigen::Vector3f>& found, bool cut) {
  if (found.size() > expected.size() || (!cut && found.size() < expected.size()))
    return std::to_string(found.size()) + " points, expected " + std::to_string(expected.size());
  for (std::size_t i = 0; i + (cut ? 1 : 0) < found.size(); ++i) {
    const double off = (found[i].cast<double>() - expected[i]).cwiseAbs().maxCoeff();
    if (!(off <= k_same_mm)) return "point " + std::to_string(i) + " is off by " + std::to_string(off);
  }
  return {};
}

/// Of the strip of triangles over all points.
std::string mesh_difference(const WrittenCloud& written, const FileContent& found) {
  if (found.faces.size() != written.points.size() - 2 + written.without_number)
    return std::to_string(found.faces.size()) + " triangles";
  for (std::size_t i = 0; i + 2 < written.points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double off = (found.places[found.faces[i][k]] - written.points[i + k]).cwiseAbs().maxCoeff();
      if (!(off <= k_same_mm)) return "triangle " + std::to_string(i) + " is off";
    }
  }
  return {};
}

Result<FileContent> read_mesh_content(const WrittenCloud& written) {
  if (written.ending == ".ply") return read_ply(written.bytes, "a.ply");
  if (written.ending == ".obj") return read_obj(written.bytes, "a.obj");
  return read_stl(written.bytes, "a.stl");
}

}  // namespace

TEST_GROUP(CloudWriters) {
  test::TemporaryFolder folder;

  void each(const std::function<void(const WrittenCloud&, const std::string&)>& check) const {
    for (int habit = 0; habit < writer_habits(); ++habit) {
      for (std::uint32_t seed = 1; seed <= k_files_each; ++seed) {
        const WrittenCloud written = write_cloud_as(habit, seed);
        check(written, "cloud" + written.ending);
      }
    }
  }
};

TEST(CloudWriters, EachHabitGivesTheSamePoints) {
  int files = 0;
  each([&](const WrittenCloud& written, const std::string& name) {
    ++files;
    const auto read = read_cloud_file(folder.write(name, written.bytes));
    CHECK_TEXT(read.has_value(), (written.writer + ": " + (read ? "" : to_line(read.error()))).c_str());
    LONGS_EQUAL_TEXT(written.without_number, read->dropped, written.writer.c_str());
    std::string difference_found;
    if (written.mesh) {
      const auto content = read_mesh_content(written);
      CHECK_TEXT(content.has_value(), written.writer.c_str());
      difference_found = mesh_difference(written, *content);
      if (read->cloud.size() < 1000) difference_found = "its surface was not sampled";
    } else {
      difference_found = difference(written.points, read->cloud.points, false);
    }
    CHECK_TEXT(difference_found.empty(),
               (written.writer + ": " + difference_found + "; " + read->understood).c_str());
  });
  CHECK(files >= 300);
}

TEST(CloudWriters, CutFilesGiveTheirBeginningOrOneTrueSentence) {
  std::mt19937 random{7};
  int refused = 0;
  each([&](const WrittenCloud& written, const std::string& name) {
    const std::size_t size = 1 + random() % (written.bytes.size() - 2);
    const auto read = read_cloud_file(folder.write(name, written.bytes.substr(0, size)));
    if (!read) {
      ++refused;
      STRCMP_CONTAINS(name.c_str(), to_line(read.error()).c_str());
      return;
    }
    // A part of a mesh's text is a mesh.
    if (written.mesh && written.ending == ".obj") return;
    const bool only_ends_missing = written.bytes.find_first_not_of("\r\n", size) == std::string::npos;
    CHECK_TEXT(!written.counted || only_ends_missing,
               (written.writer + " was cut, and nobody said so").c_str());
    if (written.mesh) return;
    const std::string off = difference(written.points, read->cloud.points, true);
    CHECK_TEXT(off.empty(), (written.writer + ", cut: " + off).c_str());
  });
  CHECK(refused > 100);
}

TEST(CloudWriters, OneRowPartedOtherwiseIsNamed) {
  for (const auto& [usual, other] :
       {std::pair{",", ";"}, {";", ","}, {"\t", ";"}, {" ", ","}, {";", " "}, {",", "\t"}}) {
    std::string text;
    for (int i = 1; i <= 50; ++i) {
      const char* const between = i == 37 ? other : usual;
      text += std::to_string(i) + ".25" + between + std::to_string(2 * i) + ".5" + between +
              std::to_string(i % 7) + ".125\n";
    }
    const auto read = read_cloud_file(folder.write("mixed.txt", text));
    CHECK_TEXT(!read.has_value(), usual);
    STRCMP_CONTAINS("row 37", to_line(read.error()).c_str());
    STRCMP_CONTAINS("expected", to_line(read.error()).c_str());
  }
}

}  // namespace biteline::cloud
