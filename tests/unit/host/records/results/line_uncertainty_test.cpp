// SPDX-License-Identifier: MIT
#include "host/records/results/line_uncertainty.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>

namespace biteline::results {
namespace {

/// A circle of 50 mm with these values on it, one after the other.
cloud::ClosedLine line_with(const std::vector<std::optional<double>>& u95_mm) {
  cloud::ClosedLine line;
  const auto count = static_cast<double>(u95_mm.size());
  for (std::size_t i = 0; i < u95_mm.size(); ++i) {
    const double angle_rad = 2 * 3.14159265358979 * static_cast<double>(i) / count;
    line.points.push_back({.position = 50 * Vec3{std::cos(angle_rad), std::sin(angle_rad), 0},
                           .normal = Vec3::UnitX(),
                           .tangent = Vec3::UnitY(),
                           .confidence = 1,
                           .u95_mm = u95_mm[i]});
  }
  return line;
}

bool has(const nlohmann::ordered_json& words, const char* word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

TEST_GROUP(LineUncertainty){};

TEST(LineUncertainty, OfEqualPointsThePooledOneIsTheirs) {
  DOUBLES_EQUAL(0.3, pooled_u95_mm(line_with({0.3, 0.3, 0.3, 0.3})), 1e-6);
}

TEST(LineUncertainty, ThePooledOneHoldsNineteenOfTwentyOfAll) {
  // Half at 0.1 and half at 1: the wide half must be held with 90 %: r = sqrt(ln 0.1 / ln 0.05) = 0.8767.
  DOUBLES_EQUAL(0.8767, pooled_u95_mm(line_with({0.1, 1.0, 0.1, 1.0})), 1e-3);
}

TEST(LineUncertainty, ReportSaysWhereItIsLargestAndWhatItHolds) {
  const auto sut = u95_json(line_with({0.1, 0.2, 0.9, 0.1}), parts_of_found_line({}));
  DOUBLES_EQUAL(0.9, sut["max_mm"].get<double>(), 1e-12);
  // The third corner of a square in a circle of 50 mm.
  DOUBLES_EQUAL(2 * 50 * std::sqrt(2.0), sut["max_at_mm"].get<double>(), 1e-6);
  CHECK(has(sut["holds"], "noise"));
  CHECK(has(sut["lacks"], "calibration"));
  CHECK(has(u95_json(line_with({0.1, 0.2, 0.9}), parts_of_found_line({.head = true}))["holds"], "clock"));
}

TEST(LineUncertainty, ReportSaysWhetherTheArmsGiveWasEstimated) {
  const auto unknown = u95_json(line_with({0.1, 0.2, 0.1}), parts_of_found_line({}));
  CHECK(has(unknown["lacks"], "the arm's give"));
  CHECK_FALSE(unknown.contains("arm_sigma_mm"));
  const auto sut = u95_json(line_with({0.1, 0.2, 0.1}),
                            parts_of_found_line({.arm = {{.sigma_mm = 0.02, .profiles = 250}}}));
  CHECK(has(sut["holds"], "the arm's give"));
  CHECK_FALSE(has(sut["lacks"], "the arm's give"));
  DOUBLES_EQUAL(0.02, sut["arm_sigma_mm"].get<double>(), 1e-12);
  CHECK_EQUAL(250, sut["arm_profiles"].get<int>());
  STRCMP_EQUAL("table", sut["arm_from"].get<std::string>().c_str());
}

TEST(LineUncertainty, ReportSaysThatAnArmIsAssumed) {
  const auto sut = u95_json(line_with({0.1, 0.2, 0.1}),
                            parts_of_found_line({.arm = {{.sigma_mm = 0.05,
                                                          .source = uncertainty::ArmSource::Assumed,
                                                          .give_mm_per_m_s2 = 0.12}}}));
  CHECK(has(sut["holds"], "the arm's give, assumed"));
  STRCMP_EQUAL("assumed", sut["arm_from"].get<std::string>().c_str());
  DOUBLES_EQUAL(0.12, sut["arm_give_mm_per_m_s2"].get<double>(), 1e-12);
  CHECK_FALSE(sut.contains("arm_profiles"));
}

TEST(LineUncertainty, ReportSaysWhatACarriedLineHolds) {
  const auto bare = u95_json(line_with({0.1, 0.2, 0.1}), parts_of_carried_line({}, false));
  for (const char* part : {"the sample's own line", "calibration", "poses", "clock", "the arm's give"})
    CHECK(has(bare["lacks"], part));
  const auto sut =
      u95_json(line_with({0.1, 0.2, 0.1}),
               parts_of_carried_line({.head = true, .arm = {{.sigma_mm = 0.02, .profiles = 250}}}, true));
  CHECK(sut["lacks"].empty());
  CHECK(has(sut["holds"], "alignment"));
  CHECK(has(sut["holds"], "the sample's own line"));
  DOUBLES_EQUAL(0.02, sut["arm_sigma_mm"].get<double>(), 1e-12);
}

TEST(LineUncertainty, APointWithoutItLeavesNothingToSay) {
  CHECK(u95_json(line_with({0.1, std::nullopt, 0.1}), parts_of_found_line({.head = true})).is_null());
  CHECK(u95_json({}, parts_of_found_line({.head = true})).is_null());
}

}  // namespace biteline::results
