// SPDX-License-Identifier: MIT
#include "host/calibration/drift/watch.hpp"

#include <CppUTest/TestHarness.h>

#include <array>

#include "tests/support/errors.hpp"
#include "tests/unit/host/calibration/drift/seen_ball.hpp"
#include "tests/unit/host/calibration/drift/seen_table_round.hpp"

namespace biteline::drift {

TEST_GROUP(Watch) {
  Watch sut;
  int shoes{0};

  void see(const Vector& drifted = Vector::Zero(), const std::string& model = {}) {
    const auto evidence = look_at(
        scan_ball({.drifted = drifted, .seed = static_cast<std::uint64_t>(100 + shoes)}).view(), ball_head());
    SUCCEEDS(evidence);
    sut.take("scan-" + std::to_string(shoes++), *evidence, model);
  }
  /// In turn; round each of them the arm bends otherwise, so that it looks like a drift of its own.
  void see_models(int count, const Vector& drifted = Vector::Zero()) {
    constexpr std::array k_names{"court", "trail", "street"};
    for (int i = 0; i < count; ++i) {
      const auto model = static_cast<std::size_t>(shoes) % k_names.size();
      const Vector bends = Vector::Unit(7) * (model == 1 ? 1.5 : 0) - Vector::Unit(12) * (model == 2 ? 2 : 0);
      see(drifted + bends, by_name ? k_names.at(model) : "");
      if (sut.verdict().status == Status::Drifted) return;
    }
  }
  bool by_name{true};
  /// As see(), on a table that stands so much higher, in fault sizes.
  void see_on_table(const Vector& drifted, const std::string& model, double higher) {
    const auto seed = static_cast<std::uint64_t>(100 + shoes);
    auto evidence = look_at(scan_ball({.drifted = drifted, .seed = seed}).view(), ball_head());
    SUCCEEDS(evidence);
    evidence->table =
        see_table(scan_table({.drifted = drifted + higher * Vector::Unit(k_table_at), .seed = seed}).view(),
                  ball_head());
    CHECK(evidence->table.has_value());
    sut.take("scan-" + std::to_string(shoes++), *evidence, model);
  }
  /// The second one on a fixture that is 40 mm higher.
  void see_on_fixtures(int count, const Vector& drifted = Vector::Zero()) {
    for (int i = 0; i < count && sut.verdict().status != Status::Drifted; ++i) {
      const bool second = shoes % 2 == 1;
      see_on_table(drifted, second ? "boot" : "court", second ? 400 : 0);
    }
  }
  void learn(int count) {
    for (int i = 0; i < count; ++i) see();
  }
};

TEST(Watch, LearnsThenIsSound) {
  see();
  CHECK(sut.verdict().status == Status::Learning);
  learn(29);
  CHECK(sut.verdict().status == Status::Sound);
  LONGS_EQUAL(30, sut.verdict().shoes);
}

TEST(Watch, NamesWhatDriftedWithinFiveShoes) {
  learn(25);
  // What this scan sees well: mounting's shift, turn, and the clock.
  const Watch sound = sut;
  for (const int i : {7, 9, 12}) {
    sut = sound;
    int after = 0;
    for (; after < 5 && sut.verdict().status != Status::Drifted; ++after) see(Vector::Unit(i));
    CHECK(sut.verdict().status == Status::Drifted);
    // The name may still hold another part; the right one is in it.
    const std::string part{
        k_part_names.at(static_cast<std::size_t>(k_table.at(static_cast<std::size_t>(i)).part))};
    STRCMP_CONTAINS(part.c_str(), sut.verdict().words.c_str());
  }
}

TEST(Watch, ModelsInTurnHaveAUsualOfTheirOwn) {
  see_models(36);
  CHECK(sut.verdict().status == Status::Sound);
  const Watch sound = *Watch::from_text(sut.to_text());
  for (const int i : {7, 12}) {
    sut = sound;
    const int before = shoes;
    see_models(5, Vector::Unit(i));
    CHECK(sut.verdict().status == Status::Drifted);
    CHECK(shoes - before <= 5);
  }
}

TEST(Watch, EachModelMayStandOnAFixtureOfItsOwn) {
  see_on_fixtures(30);
  CHECK(sut.verdict().status == Status::Sound);
  // What the table shows and the ball hardly does.
  const Watch sound = *Watch::from_text(sut.to_text());
  for (const int i : {5, 8}) {
    sut = sound;
    const int before = shoes;
    see_on_fixtures(5, Vector::Unit(i));
    CHECK(sut.verdict().status == Status::Drifted);
    CHECK(shoes - before <= 4);
  }
}

TEST(Watch, AModelOnAnotherFixtureIsLearntAnewAndTheOthersAreNot) {
  see_on_fixtures(30);
  const Watch before = sut;
  for (const int on_new : {12, 14, 18}) {
    sut = before;
    for (int i = 0; i < on_new; ++i) see_on_table(Vector::Zero(), "boot", 200);
    CHECK(sut.verdict().status == Status::Sound);
    LONGS_EQUAL(30 + on_new, sut.verdict().shoes);
    for (int i = 0; i < 5 && sut.verdict().status != Status::Drifted; ++i)
      see_on_table(Vector::Unit(5), "boot", 200);
    CHECK(sut.verdict().status == Status::Drifted);
    // Named from the shoes on the new one: those before are forgotten, and not taken away a second time.
    STRCMP_CONTAINS("laser", sut.verdict().words.c_str());
    CHECK_COMPARE(sut.verdict().for_shoes, <=, 5);
  }
}

TEST(Watch, WithoutTheirNamesTheSameModelsHideADrift) {
  by_name = false;
  see_models(36);
  see_models(5, Vector::Unit(12));
  CHECK(sut.verdict().status != Status::Drifted);
}

TEST(Watch, ADriftStaysTold) {
  learn(20);
  for (int i = 0; i < 6; ++i) see(2 * Vector::Unit(7));
  learn(12);
  CHECK(sut.verdict().status == Status::Drifted);
}

TEST(Watch, AScanIsCountedOnce) {
  const auto evidence = look_at(scan_ball({}).view(), ball_head());
  SUCCEEDS(evidence);
  sut.take("scan-0001", *evidence);
  sut.take("scan-0001", *evidence);
  LONGS_EQUAL(1, sut.verdict().shoes);
  sut.take("scan-9999", *evidence);
  // A person had an older one worked out again.
  sut.take("scan-0007", *evidence);
  LONGS_EQUAL(2, sut.verdict().shoes);
  sut.pass("scan-0008");
  sut.take("scan-0009", *evidence);
  LONGS_EQUAL(2, sut.verdict().shoes);
  sut.take("scan-10000", *evidence);
  sut.take("bench", *evidence);
  LONGS_EQUAL(4, sut.verdict().shoes);
}

TEST(Watch, GoesOnFromItsTextAsIfNothingHadBeen) {
  learn(18);
  auto copy = Watch::from_text(sut.to_text());
  SUCCEEDS(copy);
  for (int i = 0; i < 4; ++i) {
    const auto evidence =
        look_at(scan_ball({.drifted = Vector::Unit(7), .seed = static_cast<std::uint64_t>(300 + i)}).view(),
                ball_head());
    SUCCEEDS(evidence);
    const std::string name = "later-" + std::to_string(i);
    sut.take(name, *evidence);
    copy->take(name, *evidence);
  }
  CHECK(sut.verdict().status == copy->verdict().status);
  STRCMP_EQUAL(sut.verdict().words.c_str(), copy->verdict().words.c_str());
  LONGS_EQUAL(sut.verdict().shoes, copy->verdict().shoes);
  for (int i = 0; i < k_quantities; ++i) {
    DOUBLES_EQUAL(sut.row(i).sum(), copy->row(i).sum(), 1e-9);
    DOUBLES_EQUAL(sut.row(i).mean(), copy->row(i).mean(), 1e-9);
  }
}

TEST(Watch, AnEarlierReleasesDriftStaysToldUntilSomebodyCalibrates) {
  sut = *Watch::from_text(R"({"version":3,"drifted_for":4})");
  CHECK(sut.verdict().status == Status::Drifted);
  CHECK_FALSE(sut.verdict().named.has_value());
  learn(3);
  CHECK(sut.verdict().status == Status::Drifted);
  CHECK(Watch::from_text(sut.to_text())->verdict().status == Status::Drifted);
  FAILS_NAMING(Errc::BadFormat, "calibration check", Watch::from_text(R"({"version":3,"drifted_for":0})"));
}

TEST(Watch, TextThatIsNoneIsRefused) {
  see();
  const std::string text = sut.to_text();
  for (const std::string& bad :
       {std::string{}, std::string{"{}"}, std::string{"[1,2]"}, text.substr(0, text.size() / 2),
        std::string{text}.replace(text.find("\"sound_shoes\":"), 15, "\"sound_shoes\":-"),
        std::string{text}.replace(text.find("\"version\":4"), 11, "\"version\":1")}) {
    FAILS_NAMING(Errc::BadFormat, "calibration check", Watch::from_text(bad));
  }
}

TEST(Watch, WhatAScanCannotSeeIsSaid) {
  const auto turned = look_at(scan_ball({}).view(), ball_head());
  const auto same = look_at(scan_ball({.turned_rad = 0}).view(), ball_head());
  SUCCEEDS(turned);
  SUCCEEDS(same);
  CHECK(blind_of(*same).unseen.size() > blind_of(*turned).unseen.size());
}

}  // namespace biteline::drift
