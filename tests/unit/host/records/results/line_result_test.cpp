// SPDX-License-Identifier: MIT
#include "host/records/results/line_result.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <fstream>
#include <numbers>
#include <sstream>

#include "host/cloud/ply.hpp"
#include "host/records/results/pictures/shoe_view.hpp"
#include "host/records/results/pictures/stages.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::results {

namespace fs = std::filesystem;

TEST_GROUP(LineResult) {
  test::TemporaryFolder folder;

  struct Drum {
    bite_line::Extraction extraction;
    bite_line::LineStages stages;
  };

  /// An upright drum with a line half way up.
  static Drum drum(bool found) {
    Drum d;
    bite_line::Extraction& e = d.extraction;
    bite_line::LineStages& stages = d.stages;
    e.found = found;
    if (!found)
      e.refusal = bite_line::Refusal{bite_line::Refused::NoCreaseAllRound, "no crease all the way round"};
    e.confidence = found ? 0.97 : 0.1;
    e.T_base_shoe = geometry::exp_se3((Twist() << 300, 20, 5, 0, 0, 0.7).finished());
    constexpr int k_around = 800, k_up = 40;
    for (int i = 0; i < k_around * k_up; ++i) {
      const double a = 2 * std::numbers::pi * (i % k_around) / k_around;
      const Vec3 n(std::cos(a), std::sin(a), 0);
      const int ring = i / k_around;
      stages.surface.points.push_back((e.T_base_shoe * Vec3(60 * n + Vec3(0, 0, 0.5 * ring))).cast<float>());
      stages.surface.normals.push_back((e.T_base_shoe.linear() * n).cast<float>());
      const bool on_line = i / k_around == k_up / 2;
      stages.curvature_per_mm.push_back(on_line ? -0.5F : 0.01F);
      if (on_line) stages.feature_points.push_back(static_cast<std::uint32_t>(i));
    }
    stages.unrolled = {.rows = 2,
                       .cols = 3,
                       .curvature_per_mm = {0, -1, 0, 1, 0, 0},
                       .known = {1, 1, 1, 1, 0, 1},
                       .marks = {{.col = 1, .name = "toe"}},
                       .path_row = {0, 1, 1},
                       .rival_rows = {}};
    for (int i = 0; found && i < 90; ++i) {
      const double a = 2 * std::numbers::pi * i / 90;
      const Vec3 n(std::cos(a), std::sin(a), 0), t(-std::sin(a), std::cos(a), 0);
      e.line.points.push_back({.position = e.T_base_shoe * Vec3(60 * n + Vec3(0, 0, 10)),
                               .normal = e.T_base_shoe.linear() * n,
                               .tangent = e.T_base_shoe.linear() * t,
                               .confidence = 0.9});
      stages.thinned_line.push_back(e.line.points.back().position);
    }
    e.candidates.push_back({.confidence = 0.97,
                            .mean_height_mm = 10,
                            .length_mm = 377,
                            .closure_mm = 0,
                            .crease_deg = 30,
                            .seen_share = 1,
                            .points = {}});
    return d;
  }

  ExitStatus write(const Drum& d) {
    report::Report report;
    SUCCEEDS(prepare_result_folder(folder.path()));
    const auto status = write_line_result(
        folder.path(), d.stages.surface, d.extraction, [&] { return d.stages; }, report);
    SUCCEEDS(status);
    return *status;
  }
  nlohmann::json report_json() const {
    std::ifstream file(folder.path() / "report.json");
    return test::read_json(file);
  }
  bool has(const char* name) const {
    return fs::exists(folder.path() / name);
  }
};

TEST(LineResult, FoundLineLeavesEveryFile) {
  CHECK(write(drum(true)) == ExitStatus::Done);
  for (const char* name :
       {"cloud.ply", "line.csv", "report.json", "index.html", "view_data.js", "files.js",
        "stages/1_point_cloud.png", "stages/2_feature_points.ply", "stages/5_thinned_line.png",
        "stages/6_sequence.png", "stages/unrolled_curvature.png"}) {
    CHECK_TEXT(has(name), name);
  }
  const auto json = report_json();
  STRCMP_EQUAL("ok", json["status"].get<std::string>().c_str());
  DOUBLES_EQUAL(0.97, json["confidence"].get<double>(), 1e-9);
  LONGS_EQUAL(32000, json["points"].get<int>());
  LONGS_EQUAL(1, json["candidates"].size());
}

TEST(LineResult, PagesThatComeLaterKeepWhatTheReportGotMeanwhile) {
  const Drum d = drum(true);
  report::Report report;
  SUCCEEDS(prepare_result_folder(folder.path()));
  SUCCEEDS(write_line_files(folder.path(), d.stages.surface, d.extraction, report));
  CHECK(has("line.csv") && !has("index.html"));
  auto json = report_json();
  json["calibration_check"] = "drifted";
  folder.write("report.json", test::text_of(json));
  SUCCEEDS(write_line_pages(
      folder.path(), d.stages.surface, d.extraction, [&] { return d.stages; }, report));
  CHECK(has("index.html") && has("stages/6_sequence.png"));
  STRCMP_EQUAL("drifted", report_json()["calibration_check"].get<std::string>().c_str());
  LONGS_EQUAL(d.stages.feature_points.size(), report_json()["feature_points"].get<std::size_t>());
}

TEST(LineResult, RefusalRemovesTheLineOfAnEarlierRun) {
  CHECK(write(drum(true)) == ExitStatus::Done);
  CHECK(write(drum(false)) == ExitStatus::Refused);
  CHECK(!has("line.csv"));
  CHECK(!has("stages/6_sequence.png"));
  CHECK(has("stages/1_point_cloud.png"));
  STRCMP_EQUAL("no crease all the way round", report_json()["reason"].get<std::string>().c_str());
  STRCMP_EQUAL("no_crease_all_round", report_json()["reason_code"].get<std::string>().c_str());
}

TEST(LineResult, ARefusedScanShowsItsCandidatesAndThePlaceThatFailed) {
  Drum d = drum(false);
  bite_line::Candidate& best = d.extraction.candidates.front();
  for (int i = 0; i < 1500; ++i) {
    const double a = 2 * std::numbers::pi * i / 1500;
    best.points.push_back(d.extraction.T_base_shoe * Vec3(60 * std::cos(a), 60 * std::sin(a), 10));
    best.lacks.push_back(i < 300 ? static_cast<std::uint8_t>(bite_line::Lack::Crease) : 0);
  }
  d.extraction.gates.push_back({.code = bite_line::Refused::NoCreaseAllRound,
                                .measure = "longest_gap_mm",
                                .value = 120,
                                .limit = 100,
                                .at_most = true,
                                .sure = 0.08});
  CHECK(write(d) == ExitStatus::Refused);
  const nlohmann::json gate = report_json()["gates"][0];
  STRCMP_EQUAL("no_crease_all_round", gate["reason_code"].get<std::string>().c_str());
  DOUBLES_EQUAL(120, gate["value"].get<double>(), 1e-9);
  DOUBLES_EQUAL(100, gate["at_most"].get<double>(), 1e-9);

  std::ifstream file(folder.path() / "view_data.js");
  std::stringstream text;
  text << file.rdbuf();
  const std::string script = text.str();
  const nlohmann::json view =
      nlohmann::json::parse(script.substr(script.find('{'), script.rfind('}') + 1 - script.find('{')));
  CHECK_FALSE(view["found"].get<bool>());
  LONGS_EQUAL(static_cast<int>(bite_line::Lack::Crease), view["report"]["lack"].get<int>());
  const nlohmann::json& shown = view["candidates"][0];
  // Every third of 1500; the first 300 of them lack the crease.
  LONGS_EQUAL(500, shown["points"].size());
  LONGS_EQUAL(500, shown["lacks"].size());
  const auto lacks = shown["lacks"].get<std::vector<int>>();
  LONGS_EQUAL(100, std::ranges::count(lacks, static_cast<int>(bite_line::Lack::Crease)));
  const Vec3 first = best.points.front();
  DOUBLES_EQUAL(first.x(), shown["points"][0][0].get<double>(), 0.006);
}

TEST(LineResult, ALineForReviewIsWrittenWithItsOpenStretchesAndTheWaysThere) {
  Drum d = drum(true);
  bite_line::Extraction& e = d.extraction;
  e.found = false;
  e.refusal = bite_line::Refusal{bite_line::Refused::Rivalled, "two creases"};
  for (std::size_t i = 20; i < 40; ++i) {
    e.line.points[i].confidence = 0.2;
    cloud::flag_unsure(e.line.points[i]);
  }
  bite_line::Candidate other = e.candidates.front();
  for (const cloud::LinePoint& point : e.line.points) {
    e.candidates.front().points.push_back(point.position);
    other.points.push_back(point.position + Vec3{0, 0, 6});
  }
  e.candidates.push_back(other);
  CHECK(write(d) == ExitStatus::Review);
  CHECK(has("line.csv"));
  const auto json = report_json();
  STRCMP_EQUAL("review", json["status"].get<std::string>().c_str());
  STRCMP_EQUAL("rivalled", json["reason_code"].get<std::string>().c_str());
  LONGS_EQUAL(1, json["weak_stretches"].size());
  const auto& open = json["weak_stretches"][0];
  STRCMP_EQUAL("rivalled", open["reason_code"].get<std::string>().c_str());
  CHECK(open["to_mm"].get<double>() > open["from_mm"].get<double>());
  LONGS_EQUAL(1, open["alternatives"].size());
  LONGS_EQUAL(2, open["alternatives"][0]["candidate"].get<int>());
  DOUBLES_EQUAL(6, open["alternatives"][0]["off_mm"].get<double>(), 0.1);
  LONGS_EQUAL(20, open["alternatives"][0]["points"].size());
  STRCMP_CONTAINS("review: ", summary(e).c_str());
}

TEST(LineResult, FarSideOfTheShoeIsDrawnThin) {
  const Drum d = drum(true);
  const bite_line::Extraction& e = d.extraction;
  const auto count_red = [&](const std::vector<Vec3>& points) {
    results::ShoeView view{d.stages.surface, e.T_base_shoe};
    view.draw_cloud({});
    const cv::Vec3b red{0, 0, 255};
    view.draw_line(points, std::vector<cv::Vec3b>(points.size(), red));
    int reds = 0;
    // The side view is the upper panel: a drum of 20 mm height is seen in the upper fifth.
    for (int v = 0; v < view.picture().rows / 6; ++v) {
      for (int u = 0; u < view.picture().cols; ++u) reds += view.picture().at<cv::Vec3b>(v, u) == red ? 1 : 0;
    }
    return reds;
  };
  const auto at = [&](double y_mm) { return e.T_base_shoe * Vec3(0, y_mm, 15); };
  const auto beside = [&](double y_mm) { return e.T_base_shoe * Vec3(20, y_mm, 15); };
  // Seen from the right side: y = -60 is in front, y = +60 behind.
  CHECK(count_red({at(-60.5), beside(-60.5)}) > 2 * count_red({at(60.5), beside(60.5)}));
}

}  // namespace biteline::results
