// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/recognise.hpp"

#include <CppUTest/TestHarness.h>

#include <map>

#include "host/cloud/ply.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_sizes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {
namespace {

const test::MadeModel& runner() {
  static const test::MadeModel model{
      sim::ShoeClass::Deep, 3, test::FactoryLaw{}, {.profile_step_mm = 1.5, .column_step_mm = 0.2}};
  return model;
}

/// Of size 41 as it was drawn, and of one size more.
constexpr double k_next_size = 0.0247;

const transfer::SampleFiles& next_right_upper() {
  static const transfer::SampleFiles upper = runner().upper(k_next_size, true, 77, SE3::Identity());
  return upper;
}

}  // namespace

TEST_GROUP(Recognise) {
  test::TemporaryFolder folder;
  transfer::Library library{folder.path() / "models"};

  void teach(const std::string& name, const std::string& foot, const std::string& size) const {
    const transfer::SampleFiles sample = runner().sample(0);
    const std::filesystem::path path = folder.path() / name;
    std::filesystem::create_directories(path);
    SUCCEEDS(cloud::write_cloud(path / transfer::k_cloud_file, sample.cloud));
    SUCCEEDS(cloud::write_line(path / transfer::k_line_file, sample.line));
    transfer::SaveOptions options;
    options.made.foot = foot;
    options.made.size = size;
    options.made.of = "runner";
    SUCCEEDS(library.save(name, path, options));
  }
};

TEST(Recognise, FootAndSizeComeWithTheModel) {
  teach("runner-41", "left", "EU 41");
  const Result<Recognised> sut = recognise(library, next_right_upper().cloud, {});
  SUCCEEDS(sut);
  CHECK_TRUE(sut->sure());
  STRCMP_EQUAL("runner", sut->model.c_str());
  STRCMP_EQUAL("runner-41", sut->sample.c_str());
  STRCMP_EQUAL("right", sut->foot.c_str());
  STRCMP_EQUAL("EU 42", sut->size.c_str());
  STRCMP_CONTAINS("looks like runner, right, EU 42", sut->words.c_str());
  CHECK_TRUE(sut->on_scan.has_value());
}

TEST(Recognise, WhatIsOrderedAndNotSeenIsNotSure) {
  teach("runner-41", "left", "EU 41");
  const Result<Recognised> sut =
      recognise(library, next_right_upper().cloud, {.model = "runner", .foot = "left", .size = {}});
  SUCCEEDS(sut);
  CHECK_FALSE(sut->sure());
  STRCMP_CONTAINS("a left shoe was ordered", sut->words.c_str());
}

TEST(Recognise, ANameStandsAndTheShapeTellsTheRest) {
  teach("runner-41", "left", "EU 41");
  const Result<Recognised> sut = take_named(library, next_right_upper().cloud, {.model = "runner"});
  SUCCEEDS(sut);
  CHECK_TRUE(sut->sure());
  STRCMP_EQUAL("right", sut->foot.c_str());
  CHECK_TRUE(sut->align.mirror && sut->align.grade);
}

TEST(Recognise, AFootThatIsNamedAndNotSeenIsNotSure) {
  teach("runner-41", "left", "EU 41");
  const Result<Recognised> sut =
      take_named(library, next_right_upper().cloud, {.model = "runner", .foot = "left", .size = {}});
  SUCCEEDS(sut);
  CHECK_FALSE(sut->sure());
}

TEST(Recognise, ASampleThatSaysNothingIsTakenByItsNameUnseen) {
  teach("runner-41", "", "");
  const Result<Recognised> sut =
      take_named(library, next_right_upper().cloud, {.model = "runner", .foot = "right", .size = "EU 42"});
  SUCCEEDS(sut);
  CHECK_TRUE(sut->sure());
  STRCMP_EQUAL("right", sut->foot.c_str());
  CHECK_FALSE(sut->on_scan.has_value());
}

TEST(Recognise, AModelThatNobodyHasTaughtFails) {
  FAILS_NAMING(Errc::FileNotFound, "no model boot",
               take_named(library, next_right_upper().cloud, {.model = "boot"}));
}

TEST(Recognise, PlacesAreDistancesToTheModelsLineOutwardsAboveZero) {
  const cloud::ClosedLine model = runner().sample(0).line;
  cloud::ClosedLine line = model;
  for (cloud::LinePoint& point : line.points) point.position += 0.5 * point.normal;
  for (const float place : places_of(line, model)) DOUBLES_EQUAL(0.5, place, 0.02);
}

}  // namespace biteline::service
