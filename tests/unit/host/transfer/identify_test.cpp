// SPDX-License-Identifier: MIT
#include "host/transfer/identify.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "host/cloud/ply.hpp"
#include "host/transfer/align/rough_fit.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_cloud.hpp"
#include "tests/support/made_pair.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::transfer {
namespace {

const sim::ScanSettings k_scan{.profile_step_mm = 1.5, .column_step_mm = 0.2};

/// What the service asks for before it takes a model by itself.
constexpr double k_sure_of_model = 0.95;

/// Made once: the slow part of these tests.
const test::MadePair& pair_of(std::uint64_t seed) {
  static std::map<std::uint64_t, test::MadePair> pairs;
  const auto [at, is_new] = pairs.try_emplace(seed);
  if (is_new) at->second = test::made_pair({.seed = seed, .scan = k_scan});
  return at->second;
}

}  // namespace

TEST_GROUP(Identify) {
  test::TemporaryFolder folder;
  Library library{folder.path() / "models"};

  /// Saves the sample of that seed; hands back the next upper of its model.
  cloud::PointCloud teach(const std::string& name, std::uint64_t seed) const {
    const test::MadePair& pair = pair_of(seed);
    const std::filesystem::path path = folder.path() / name;
    std::filesystem::create_directories(path);
    SUCCEEDS(cloud::write_cloud(path / k_cloud_file, pair.sample_cloud));
    SUCCEEDS(cloud::write_line(path / k_line_file, pair.sample_line));
    SUCCEEDS(library.save(name, path));
    return pair.upper_cloud;
  }
};

TEST(Identify, NamesTheModelAndHowSure) {
  const cloud::PointCloud upper = teach("first", 1);
  teach("second", 2);
  const Result<Identification> sut = identify(library, upper, {});
  SUCCEEDS(sut);
  STRCMP_EQUAL("first", sut->name.c_str());
  LONGS_EQUAL(2, sut->matches.size());
  CHECK(sut->matches[0].probability >= k_sure_of_model);
  DOUBLES_EQUAL(0.0, sut->matches[1].probability, 1e-9);
}

TEST(Identify, OneOfSeveralIsNamedWithItsSoleAndWithout) {
  std::map<std::string, cloud::PointCloud> uppers;
  std::uint64_t seed = 1;
  for (const char* name : {"first", "second", "third", "fourth"}) uppers[name] = teach(name, seed++);
  for (const auto& [name, upper] : uppers) {
    const Result<Identification> sut = identify(library, upper, {});
    SUCCEEDS(sut);
    STRCMP_EQUAL(name.c_str(), sut->name.c_str());
    CHECK_TEXT(sut->matches[0].probability >= k_sure_of_model, name.c_str());
    CHECK_TEXT(sut->matches[1].probability <= 1 - k_sure_of_model, name.c_str());
  }
  // The next shoe of the third model, its sole on, elsewhere on the table.
  const SE3 elsewhere =
      geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{1.3, Vec3::UnitZ()}}, {400, 20, 51});
  const cloud::PointCloud shoe = test::scanned(sim::draw_shoe(sim::ShoeClass::Deep, 3), elsewhere, k_scan);
  const Result<Identification> sut = identify(library, shoe, {});
  SUCCEEDS(sut);
  STRCMP_EQUAL("third", sut->name.c_str());
  CHECK(sut->matches[0].probability >= k_sure_of_model);
}

TEST(Identify, LeftAndRightAreTwoModels) {
  const test::MadePair& pair = pair_of(1);
  const cloud::PointCloud left = teach("left", 1);
  // The mirror image of all of it is the other foot's.
  const auto mirrored = [](Vec3 v) { return Vec3{v.x(), -v.y(), v.z()}; };
  cloud::PointCloud sample = pair.sample_cloud, right = pair.upper_cloud;
  for (cloud::PointCloud* cloud : {&sample, &right}) {
    for (Eigen::Vector3f& point : cloud->points) point.y() = -point.y();
  }
  cloud::ClosedLine line = pair.sample_line;
  for (cloud::LinePoint& point : line.points) {
    point.position = mirrored(point.position);
    point.normal = mirrored(point.normal);
    point.tangent = -mirrored(point.tangent);
  }
  std::reverse(line.points.begin(), line.points.end());
  const std::filesystem::path path = folder.path() / "right";
  std::filesystem::create_directories(path);
  SUCCEEDS(cloud::write_cloud(path / k_cloud_file, sample));
  SUCCEEDS(cloud::write_line(path / k_line_file, line));
  SUCCEEDS(library.save("right", path));
  const std::map<std::string, const cloud::PointCloud*> uppers{{"left", &left}, {"right", &right}};
  for (const auto& [name, upper] : uppers) {
    const Result<Identification> sut = identify(library, *upper, {});
    SUCCEEDS(sut);
    STRCMP_EQUAL(name.c_str(), sut->name.c_str());
    CHECK_TEXT(sut->matches[0].probability >= k_sure_of_model, name.c_str());
  }
}

TEST(Identify, NoneOfThemIsAnAnswer) {
  const cloud::PointCloud upper = teach("first", 1);
  SUCCEEDS(library.remove("first"));
  teach("second", 2);
  const Result<Identification> sut = identify(library, upper, {});
  SUCCEEDS(sut);
  CHECK(sut->name.empty());
  CHECK(sut->refusal->code == Refused::NoModelFits);
  STRCMP_CONTAINS("none of the 1 models", sut->refusal->reason.c_str());
}

TEST(Identify, AnUpperThatWasPushedWhileItWasScannedIsToldSo) {
  const cloud::PointCloud upper = teach("first", 1);
  // So far that it looks like no model.  Two ways at right angles: one is not along the wall at the seam.
  int told = 0;
  for (const Eigen::Vector3f& by_mm : {Eigen::Vector3f{4, 0, 0}, Eigen::Vector3f{0, 4, 0}}) {
    const Result<Identification> sut = identify(library, test::pushed(upper, 0.5, by_mm), {});
    SUCCEEDS(sut);
    CHECK(sut->name.empty());
    if (sut->refusal->code == Refused::DoesNotClose) ++told;
  }
  CHECK_COMPARE(told, >=, 1);
}

TEST(Identify, TwoThatBothFitAreToldAndNotChosenFrom) {
  const cloud::PointCloud upper = teach("first", 1);
  teach("twin", 1);
  const Result<Identification> sut = identify(library, upper, {});
  SUCCEEDS(sut);
  CHECK(sut->name.empty());
  CHECK(sut->refusal->code == Refused::SeveralModelsFit);
  STRCMP_CONTAINS("first", sut->refusal->reason.c_str());
  STRCMP_CONTAINS("twin", sut->refusal->reason.c_str());
}

TEST(Identify, OnlyTheNearOnesAreComparedAndTheOthersSayWhy) {
  std::uint64_t seed = 1;
  for (const char* name : {"first", "second", "third", "fourth", "fifth", "sixth"}) teach(name, seed++);
  const Result<Identification> sut = identify(library, pair_of(4).upper_cloud, {});
  SUCCEEDS(sut);
  STRCMP_EQUAL("fourth", sut->name.c_str());
  LONGS_EQUAL(6, sut->matches.size());
  CHECK(sut->matches[0].compared);
  CHECK(sut->matches[0].rough_fit_mm <= k_most_rough_mm);
  const Match& last = sut->matches.back();
  CHECK_FALSE(last.compared);
  CHECK_FALSE(last.alignment.accepted());
  STRCMP_CONTAINS("set aside", last.alignment.reason.c_str());
  CHECK(last.rough_fit_mm > k_most_rough_mm);
}

TEST(Identify, ADamagedModelIsLeftOutAndTold) {
  const cloud::PointCloud upper = teach("first", 1);
  teach("second", 2);
  std::ofstream(library.path_of("second") / k_line_file) << "x";
  const Result<Identification> sut = identify(library, upper, {});
  SUCCEEDS(sut);
  STRCMP_EQUAL("first", sut->name.c_str());
  LONGS_EQUAL(1, sut->damaged.size());
  STRCMP_EQUAL("second", sut->damaged[0].name.c_str());
  SUCCEEDS(library.remove("first"));
  STRCMP_CONTAINS("second", identify(library, upper, {})->refusal->reason.c_str());
}

}  // namespace biteline::transfer
