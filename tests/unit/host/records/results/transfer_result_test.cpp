// SPDX-License-Identifier: MIT
#include "host/records/results/transfer_result.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>
#include <numbers>

#include "host/records/results/line_result.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::results {

namespace fs = std::filesystem;

TEST_GROUP(TransferResult) {
  test::TemporaryFolder folder;
  cloud::PointCloud upper;

  void setup() override {
    for (int i = 0; i < 4000; ++i) {
      const int ring = i / 100;
      upper.points.push_back(on_drum(i, 0.1F * static_cast<float>(ring)));
    }
  }

  static Eigen::Vector3f on_drum(int hundredth, float height_mm) {
    const double a = 2 * std::numbers::pi * hundredth / 100;
    return {static_cast<float>(60 * std::cos(a)), static_cast<float>(60 * std::sin(a)), height_mm};
  }

  /// As far as an alignment came; then with its line.
  transfer::Transfer transfer(bool found) const {
    transfer::Transfer out;
    out.stages = {{.name = "prepare", .seconds = 0.1}, {.name = "align", .seconds = 0.2}};
    out.alignment.compared = {{.point = upper.points[0], .difference_mm = 0.1F},
                              {.point = upper.points[1], .difference_mm = -0.2F}};
    out.alignment.weakest.words = "up and down";
    out.bound_mm = 0.2;
    out.found = found;
    if (!found)
      out.refusal =
          transfer::Refusal{.code = transfer::Refused::OtherModel, .reason = "the upper is another model"};
    for (int i = 0; found && i < 100; ++i) {
      const Vec3 p = on_drum(i, 2).cast<double>(), n{p.x() / 60, p.y() / 60, 0};
      out.placed.push_back({.position = p, .normal = n});
      out.carried.line.points.push_back(
          {.position = p, .normal = n, .tangent = {-n.y(), n.x(), 0}, .confidence = 0.9});
      out.carried.bridged.push_back(i == 7);
    }
    return out;
  }

  ExitStatus write(const transfer::Transfer& transfer) {
    report::Report report;
    SUCCEEDS(prepare_result_folder(folder.path()));
    const auto status = write_transfer_result(folder.path(), upper, transfer, report);
    SUCCEEDS(status);
    return *status;
  }
  nlohmann::json report_json() const {
    std::ifstream file(folder.path() / "report.json");
    return test::read_json(file);
  }
  bool has(const char* file) const {
    return fs::exists(folder.path() / file);
  }
};

TEST(TransferResult, ALineHasItsFilesAndPictures) {
  CHECK(write(transfer(true)) == ExitStatus::Done);
  for (const char* file : {"line.csv", "index.html", "stages/1_alignment.png", "stages/1_alignment.ply",
                           "stages/2_placed_line.png", "stages/3_carried_line.png"}) {
    CHECK_TEXT(has(file), file);
  }
  const auto report = report_json();
  STRCMP_EQUAL("ok", report["status"].get<std::string>().c_str());
  DOUBLES_EQUAL(0.2, report["bound_mm"].get<double>(), 1e-12);
  LONGS_EQUAL(7, report["bridged_points"][0].get<int>());
}

TEST(TransferResult, ARefusalShowsWhereTheShapesDifferAndLeavesNoEarlierLine) {
  CHECK(write(transfer(true)) == ExitStatus::Done);
  CHECK(write(transfer(false)) == ExitStatus::Refused);
  CHECK(has("stages/1_alignment.png"));
  for (const char* file : {"line.csv", "stages/2_placed_line.png", "stages/3_carried_line.png"})
    CHECK_TEXT(!has(file), file);
  STRCMP_EQUAL("the upper is another model", report_json()["reason"].get<std::string>().c_str());
  STRCMP_EQUAL("other_model", report_json()["reason_code"].get<std::string>().c_str());
}

TEST(TransferResult, ACloudWithoutShoeIsARefusalWithoutPictures) {
  transfer::Transfer nothing;
  nothing.refusal =
      transfer::Refusal{.code = transfer::Refused::UpperWithoutShoe, .reason = "no surface of a shoe's size"};
  upper.points.clear();
  CHECK(write(nothing) == ExitStatus::Refused);
  CHECK(has("index.html"));
  CHECK(!report_json().contains("alignment"));
}

}  // namespace biteline::results
