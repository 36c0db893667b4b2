// SPDX-License-Identifier: MIT
// `biteline capture accept` on made scans of pieces: a good head, one whose scale is wrong, one that bends
// planes.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include "common/geometry/se3.hpp"
#include "host/cloud/ply.hpp"
#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

TEST_GROUP(AcceptTool) {
  static constexpr double k_noise_mm = 0.015, k_ball_mm = 30, k_bar_mm = 150, k_step_mm = 12.5;
  test::TemporaryFolder folder;
  std::mt19937 random{5};
  /// What the head makes of a true point.
  double scale{1}, bow_mm{0};
  std::string table;

  double any(double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random);
  }
  double noise() {
    return std::normal_distribution<double>{0, k_noise_mm}(random);
  }
  Vec3 seen(const Vec3& at) const {
    return scale * at + Vec3{0, 0, bow_mm * std::pow(at.x() / 30, 2)};
  }
  void add_ball(cloud::PointCloud & cloud, const Vec3& middle) {
    for (int i = 0; i < 1500; ++i) {
      const double z = any(0.2, 1), turn = any(0, 2 * std::numbers::pi), rho = std::sqrt(1 - z * z);
      const Vec3 up{rho * std::cos(turn), rho * std::sin(turn), z};
      cloud.points.push_back(seen(middle + (k_ball_mm / 2 + noise()) * up).cast<float>());
    }
  }
  void add_plane(cloud::PointCloud & cloud, const Vec3& corner) {
    for (int i = 0; i < 1500; ++i)
      cloud.points.push_back(seen(corner + Vec3{any(0, 60), any(0, 40), noise()}).cast<float>());
  }
  void keep(const cloud::PointCloud& cloud, const std::string& row_begin, const std::string& row_end) {
    const std::string name = "scan-" + std::to_string(std::ranges::count(table, '\n')) + ".ply";
    SUCCEEDS(cloud::write_cloud(folder.path() / name, cloud));
    table += row_begin + "," + name + row_end + "\n";
  }
  void scan_pieces(int balls, int bars, int planes, int steps) {
    for (int i = 0; i < balls; ++i) {
      cloud::PointCloud cloud;
      add_ball(cloud, {any(-100, 100), any(-100, 100), any(0, 60)});
      keep(cloud, "ball", "," + std::to_string(k_ball_mm));
    }
    for (int i = 0; i < bars; ++i) {
      cloud::PointCloud cloud;
      const double turn = any(0, std::numbers::pi);
      add_ball(cloud, {0, 0, 20});
      add_ball(cloud, {k_bar_mm * std::cos(turn), k_bar_mm * std::sin(turn), 20});
      keep(cloud, "bar", "," + std::to_string(k_ball_mm) + "," + std::to_string(k_bar_mm));
    }
    for (int i = 0; i < planes; ++i) {
      cloud::PointCloud cloud;
      add_plane(cloud, {-30, any(-50, 50), any(0, 50)});
      keep(cloud, "plane", "");
    }
    for (int i = 0; i < steps; ++i) {
      cloud::PointCloud cloud;
      add_plane(cloud, {-30, -20, 0});
      add_plane(cloud, {-30, 25, k_step_mm});
      keep(cloud, "step", "," + std::to_string(k_step_mm));
    }
  }
  struct Said {
    int status{0};
    std::string last_error;
  };
  Said accept(const std::vector<std::string>& more = {}) {
    folder.write("pieces.csv", "#piece,scan,known [mm]\n" + table);
    std::vector<std::string> arguments{"capture",
                                       "accept",
                                       (folder.path() / "pieces.csv").string(),
                                       "--out",
                                       (folder.path() / "out").string(),
                                       "--head",
                                       "head 17",
                                       "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = arguments});
    SUCCEEDS(child);
    Said said;
    while (child->next_line(std::chrono::minutes{2})) {
    }
    said.status = child->wait(std::chrono::minutes{2}).value_or(-1);
    said.last_error = child->last_words();
    return said;
  }
  nlohmann::json report() const {
    std::ifstream file(folder.path() / "out" / "report.json");
    return test::read_json(file);
  }
  bool passed(const char* figure) const {
    return report()["results"][figure]["passed"].get<bool>();
  }
  double worst_mm(const char* figure) const {
    return report()["results"][figure]["worst_mm"].get<double>();
  }
};

TEST(AcceptTool, AGoodHeadPassesWithAPageToSign) {
  scan_pieces(10, 7, 6, 3);
  LONGS_EQUAL(0, accept().status);
  CHECK(report()["passed"].get<bool>() && report()["complete"].get<bool>());
  LONGS_EQUAL(10 * 2 + 7 + 6 + 3, report()["measurements"].size());
  LONGS_EQUAL(26, report()["scans_sha256"].size());
  // The range of 99.7 % of a normal scatter is 5.94 of its deviations; of the worst of ten a little more.
  CHECK(worst_mm("probing_form") > 5 * k_noise_mm && worst_mm("probing_form") < 8 * k_noise_mm);
  std::ifstream page(folder.path() / "out" / "index.html");
  const std::string text{std::istreambuf_iterator<char>{page}, {}};
  STRCMP_CONTAINS("head 17", text.c_str());
  STRCMP_CONTAINS("signature", text.c_str());
}

TEST(AcceptTool, AScaleThatIsWrongShowsInTheLongestPiece) {
  scale = 1.002;
  scan_pieces(1, 1, 1, 1);
  LONGS_EQUAL(3, accept().status);
  // 0.3 mm of 150 mm, 0.06 mm of 30 mm, 0.025 mm of 12.5 mm; each within four deviations of 1500 points'
  // ball.
  const double known_to_mm = 4 * 2 * k_noise_mm / std::sqrt(1500) * 5;
  DOUBLES_EQUAL(0.002 * k_bar_mm, worst_mm("spacing"), known_to_mm);
  DOUBLES_EQUAL(0.002 * k_ball_mm, worst_mm("probing_size"), known_to_mm);
  CHECK_FALSE(passed("spacing"));
  STRCMP_EQUAL("beyond_limit", report().value("reason_code", "").c_str());
  CHECK(passed("probing_size") && passed("flatness") && passed("step"));
  CHECK_FALSE(report()["complete"].get<bool>());
  LONGS_EQUAL(0, accept({"--spacing-mm", "0.4"}).status);
}

TEST(AcceptTool, AHeadThatBendsPlanesIsNotFlat) {
  bow_mm = 0.4;
  scan_pieces(0, 0, 2, 0);
  LONGS_EQUAL(3, accept().status);
  CHECK_FALSE(passed("flatness"));
  CHECK(worst_mm("flatness") > bow_mm && worst_mm("flatness") < bow_mm + 6 * k_noise_mm);
}

TEST(AcceptTool, WhatIsWrongInTheTableIsNamed) {
  table = "ball,scan-0.ply\n";
  STRCMP_CONTAINS("row 2", accept().last_error.c_str());
  table = "cube,scan-0.ply,10\n";
  LONGS_EQUAL(2, accept().status);
  table.clear();
  STRCMP_CONTAINS("no piece in it", accept().last_error.c_str());
  scan_pieces(0, 0, 1, 0);
  table.replace(0, 5, "ball");
  table.insert(table.find('\n'), ",30");
  const Said said = accept();
  LONGS_EQUAL(3, said.status);
  STRCMP_CONTAINS("scan-0.ply: no ball", said.last_error.c_str());
}

}  // namespace biteline
