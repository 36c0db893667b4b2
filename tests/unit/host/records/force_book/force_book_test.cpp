// SPDX-License-Identifier: MIT
#include "host/records/force_book/force_book.hpp"

#include <CppUTest/TestHarness.h>

#include "host/records/force_book/tool_wear.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::force_book {
namespace {

constexpr double k_set_newton = 20;

path::ForceTold told(double newton) {
  path::ForceTold told{
      .samples = 1000, .within = 0.9, .mean_newton = newton, .largest_newton = newton, .along_mm = 0.5};
  for (int i = 0; i < 1000; ++i) told.learn.push_back({i / 1000.0, Vec3{-newton, 0, 0}, Vec3::UnitX()});
  return told;
}

}  // namespace

TEST_GROUP(ForceBook) {
  test::TemporaryFolder folder;
  Result<memory::Memory> memory{memory::Memory::open(folder.path() / memory::k_memory_file)};
  Subject of{.model = "oxford", .foot = "left", .process = "grind", .process_sha256 = "aa", .tip = "0 0 180"};
};

TEST(ForceBook, AtFirstNothingIsLearned) {
  const auto found = learned(*memory, of);
  SUCCEEDS(found);
  CHECK_FALSE(found->has_value());
  CHECK(read_all(*memory)->empty());
}

/// What was missing on one shoe comes ahead on the next one, also in a memory that is opened again.
TEST(ForceBook, ShoeIsKeptForTheNextOne) {
  SUCCEEDS(learn_shoe(*memory, of, k_set_newton, "scan-0001", told(18)));
  memory = memory::Memory::open(folder.path() / memory::k_memory_file);
  SUCCEEDS(memory);
  const auto found = learned(*memory, of);
  SUCCEEDS(found);
  CHECK(found->has_value());
  LONGS_EQUAL(1, (*found)->shoes);
  // A first gain of 0.9 on 2 N.
  for (const double newton : (*found)->ahead_newton) DOUBLES_EQUAL(1.8, newton, 1e-6);
  DOUBLES_EQUAL(1.8, path::drift_of(**found).ahead_newton, 1e-6);
  const auto all = read_all(*memory);
  SUCCEEDS(all);
  LONGS_EQUAL(1, all->size());
  STRCMP_EQUAL("scan-0001", all->front().shoes.front().scan.c_str());
}

TEST(ForceBook, OtherFootModelOrProcessLearnsForItself) {
  SUCCEEDS(learn_shoe(*memory, of, k_set_newton, "scan-0001", told(18)));
  for (std::string Subject::*part : {&Subject::model, &Subject::foot, &Subject::process}) {
    Subject other = of;
    other.*part = "other";
    CHECK_FALSE(learned(*memory, other)->has_value());
  }
}

/// A changed text of the process, or a tip that was taught anew: nothing counts, and the next shoe is the
/// first.
TEST(ForceBook, ChangedToolOrProcessBeginsAnew) {
  for (std::string Subject::*part : {&Subject::process_sha256, &Subject::tip}) {
    SUCCEEDS(learn_shoe(*memory, of, k_set_newton, "scan-0001", told(18)));
    Subject changed = of;
    changed.*part = "changed";
    CHECK_FALSE(learned(*memory, changed)->has_value());
    const auto entry = learn_shoe(*memory, changed, k_set_newton, "scan-0002", told(19));
    SUCCEEDS(entry);
    LONGS_EQUAL(1, entry->learned.shoes);
    LONGS_EQUAL(1, entry->shoes.size());
    LONGS_EQUAL(1, read_all(*memory)->size());
    of = changed;
  }
}

TEST(ForceBook, AirRunTeachesTheSensorsError) {
  std::vector<path::ForceSample> samples;
  for (int i = 0; i < 1440; ++i)
    samples.push_back({i / 1440.0, Vec3{i < 720 ? 1.0 : -1.0, 0, 0}, Vec3::UnitX()});
  const auto entry = learn_air(*memory, of, k_set_newton, "scan-0001", samples);
  SUCCEEDS(entry);
  LONGS_EQUAL(1, entry->learned.air_runs);
  DOUBLES_EQUAL(1, path::drift_of(entry->learned).error_newton, 1e-3);
}

TEST(ForceBook, ForgetsAModelAndNoOther) {
  Subject right = of, other = of;
  right.foot = "right";
  other.model = "oxford2";
  for (const Subject& one : {of, right, other})
    SUCCEEDS(learn_shoe(*memory, one, k_set_newton, "scan-0001", told(18)));
  const auto gone = forget(*memory, "oxford", "eng");
  SUCCEEDS(gone);
  LONGS_EQUAL(2, *gone);
  CHECK_FALSE(learned(*memory, of)->has_value());
  CHECK(learned(*memory, other)->has_value());
  LONGS_EQUAL(1, read_all(*memory)->size());
  LONGS_EQUAL(0, *forget(*memory, "oxford", "eng"));
}

/// What somebody else wrote there is no force to press with.
TEST(ForceBook, ForeignTextIsRefusedInOneLine) {
  SUCCEEDS(learn_shoe(*memory, of, k_set_newton, "scan-0001", told(18)));
  const std::string key = "force_learned\noxford\nleft\ngrind";
  const std::string good = memory->setting(key)->value();
  for (const std::string& bad : {std::string{"{}"}, std::string{"no json"}, good.substr(0, good.size() - 1),
                                 std::string{good}.replace(good.find("\"shoes\":1"), 9, "\"shoes\":x")}) {
    SUCCEEDS(memory->put_setting(
        key, bad,
        {.id = 0, .who = "x", .door = {}, .action = "x", .subject = {}, .before = {}, .after = {}}));
    const auto found = learned(*memory, of);
    CHECK(!found.has_value());
    CHECK(found.error().code == Errc::BadFormat);
    CHECK(!learn_shoe(*memory, of, k_set_newton, "scan-0002", told(18)).has_value());
  }
  // And it can be dropped.
  LONGS_EQUAL(1, *forget(*memory, "oxford", "eng"));
  CHECK_FALSE(learned(*memory, of)->has_value());
}

/// Over two models with a level of each, since its disc is a new one; another tool's shoes are none of it.
TEST(ForceBook, WearIsOfAToolByItsName) {
  Subject other = of;
  other.model = "derby";
  const auto press = [&](const Subject& subject, const char* tool, double along_mm) {
    path::ForceTold shoe = told(20);
    shoe.along_mm = along_mm;
    SUCCEEDS(learn_shoe(*memory, subject, k_set_newton, "scan", shoe, tool));
  };
  for (int i = 0; i < 6; ++i) {
    press(i % 2 == 0 ? of : other, "disc", (i % 2 == 0 ? 0.5 : 1.4) + 0.02 * i);
    press(of, "brush", 0.7);
  }
  const auto entries = read_all(*memory);
  SUCCEEDS(entries);
  const ToolWear disc = wear_of_tool(*entries, "disc", 0), brush = wear_of_tool(*entries, "brush", 0);
  LONGS_EQUAL(6, disc.shoes);
  CHECK(disc.trend && disc.trend->sure());
  DOUBLES_EQUAL(0.02, disc.trend->slope, 1e-9);
  STRCMP_CONTAINS("0.0200 mm", words_of(disc).c_str());
  CHECK(brush.trend && !brush.trend->sure());
  STRCMP_CONTAINS("no wear", words_of(brush).c_str());
  const ToolWear renewed = wear_of_tool(*entries, "disc", memory::now_ms());
  LONGS_EQUAL(0, renewed.shoes);
  CHECK(!renewed.trend && to_json(renewed)["mm_per_shoe"].is_null());
}

}  // namespace biteline::force_book
