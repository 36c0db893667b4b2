// SPDX-License-Identifier: MIT
#include "host/records/results/tracking_page/tracking_page.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/json.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::results {
namespace {

std::size_t occurrences(const std::string& text, const std::string& of) {
  std::size_t count = 0;
  for (std::size_t at = text.find(of); at != std::string::npos; at = text.find(of, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_GROUP(TrackingPage) {
  path::PlannedPath path = robot::test::planned_path("grind.yaml").path();
  kinematics::ArmModel arm = *kinematics::arm_model("UR5e");
  path::Tool tool;
  std::string page;

  void write(const std::vector<Vec3>& shoe) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "biteline_tracking_test.html";
    CHECK(write_tracking_page(file, {.path = path,
                                     .arm = arm,
                                     .tool = tool,
                                     .shoe_points_base = shoe,
                                     .shoe_is_guessed = true,
                                     .table_z_mm = 40,
                                     .track = {}})
              .has_value());
    std::ifstream in{file};
    page.assign(std::istreambuf_iterator<char>{in}, {});
    std::filesystem::remove(file);
  }
  nlohmann::json data() {
    const std::string mark = "const data = ";
    const std::size_t begin = page.find(mark) + mark.size();
    return test::read_json(page.substr(begin, page.find(";\n", begin) - begin));
  }
};

TEST(TrackingPage, NeedsNothingFromElsewhere) {
  write({});
  CHECK_EQUAL(0U, occurrences(page, "BITELINE_"));
  CHECK_EQUAL(0U, occurrences(page, "<script src"));
  // The icon is empty, and named so that no browser asks for one.
  CHECK_EQUAL(occurrences(page, "<link rel=\"icon\" href=\"data:,\">"), occurrences(page, "<link"));
  CHECK(page.find("WebGLRenderer") != std::string::npos);
  CHECK_EQUAL(2U, occurrences(page, "</script>"));
}

TEST(TrackingPage, CarriesEveryWaypointAndTheArm) {
  write({Vec3{1, 2, 3}});
  const nlohmann::json read = data();
  CHECK_EQUAL(path.waypoints.size(), read["path"]["time"].size());
  CHECK_EQUAL(6U, read["arm"]["frames"].size());
  CHECK_EQUAL(kinematics::k_link_capsules, read["arm"]["links"].size());
  DOUBLES_EQUAL(path.waypoints[7].q_rad[3], read["path"]["q"][7][3].get<double>(), 1e-4);
  // Row-major: the forearm's frame stands a2 along the upper arm's x.
  DOUBLES_EQUAL(-425, read["arm"]["frames"][2][3].get<double>(), 1e-9);
  CHECK_EQUAL(3U, read["shoe"].size());
}

TEST(TrackingPage, LargeCloudsAreThinnedAndNamesCannotEndTheScript) {
  path.process = "</script><b>";
  write(std::vector<Vec3>(100000, Vec3{1, 2, 3}));
  CHECK(data()["shoe"].size() <= 3 * k_most_points);
  CHECK_EQUAL(2U, occurrences(page, "</script>"));
  STRCMP_EQUAL("</script><b>", data()["process"].get<std::string>().c_str());
}

}  // namespace biteline::results
