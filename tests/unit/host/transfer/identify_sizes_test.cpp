// SPDX-License-Identifier: MIT
// One model in many sizes and both feet: what a library of two samples says of its uppers.
#include <CppUTest/TestHarness.h>

#include <map>

#include "host/cloud/ply.hpp"
#include "host/transfer/identify.hpp"
#include "host/transfer/shape_store.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/line_distance.hpp"
#include "tests/support/made_sizes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::transfer {
namespace {

const sim::ScanSettings k_sizes_scan{.profile_step_mm = 1.5, .column_step_mm = 0.2};
constexpr double k_mm_per_size = 20.0 / 3;

const test::MadeModel& runner() {
  static const test::MadeModel model{sim::ShoeClass::Deep, 3, test::FactoryLaw{}, k_sizes_scan};
  return model;
}

const test::MadeModel& court() {
  static const test::MadeModel model{sim::ShoeClass::Shallow, 4, test::FactoryLaw{}, k_sizes_scan};
  return model;
}

/// Size 41 is the shoe as it was drawn.
double change_of(const test::MadeModel& model, double size) {
  return (size - 41) * k_mm_per_size / model.length_mm();
}

const SampleFiles& sample_of(const test::MadeModel& model, int size) {
  static std::map<std::pair<const test::MadeModel*, int>, SampleFiles> made;
  const auto [at, is_new] = made.try_emplace({&model, size});
  if (is_new) at->second = model.sample(change_of(model, size));
  return at->second;
}

SampleFiles upper_of_size(const test::MadeModel& model, double size, bool right) {
  const SE3 T_base_upper =
      geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{1.1, Vec3::UnitZ()}}, {430, 90, 48});
  return model.upper(change_of(model, size), right, 77, T_base_upper);
}

}  // namespace

TEST_GROUP(IdentifySizes) {
  test::TemporaryFolder folder;
  Library library{folder.path() / "models"};

  void teach(const std::string& name, const SampleFiles& sample, const ModelMade& made) const {
    const std::filesystem::path path = folder.path() / name;
    std::filesystem::create_directories(path);
    SUCCEEDS(cloud::write_cloud(path / k_cloud_file, sample.cloud));
    SUCCEEDS(cloud::write_line(path / k_line_file, sample.line));
    SaveOptions options;
    options.made = made;
    SUCCEEDS(library.save(name, path, options));
  }
  static ModelMade left(const std::string& of, const std::string& size) {
    ModelMade made;
    made.foot = "left";
    made.size = size;
    made.of = of;
    return made;
  }
  void teach_runner() const {
    teach("runner-39", sample_of(runner(), 39), left("runner", "EU 39"));
    teach("runner-43", sample_of(runner(), 43), left("runner", "EU 43"));
  }
};

TEST(IdentifySizes, TheOtherFootOfASampleIsTold) {
  teach_runner();
  const Result<Identification> sut = identify(library, upper_of_size(runner(), 39, true).cloud);
  SUCCEEDS(sut);
  STRCMP_EQUAL("runner-39", sut->name.c_str());
  const Match& best = sut->matches.front();
  STRCMP_EQUAL("runner", best.model.c_str());
  STRCMP_EQUAL("right", best.foot.c_str());
  STRCMP_EQUAL("EU 39", best.size.c_str());
  CHECK_TRUE(best.align.mirror);
  CHECK_FALSE(best.align.grade);
}

TEST(IdentifySizes, AnotherSizeIsToldAndTakenFromTheNearerSample) {
  teach_runner();
  const SampleFiles upper = upper_of_size(runner(), 42, true);
  const Result<Identification> sut = identify(library, upper.cloud);
  SUCCEEDS(sut);
  STRCMP_EQUAL("runner-43", sut->name.c_str());
  const Match& best = sut->matches.front();
  STRCMP_EQUAL("right", best.foot.c_str());
  STRCMP_EQUAL("EU 42", best.size.c_str());
  CHECK_TRUE(best.align.mirror && best.align.grade);
  // The factory's own law, not the usual one.
  CHECK(best.align.law.taught_at != 0);
  const Transfer carried = transfer_line(*library.load(sut->name), upper.cloud, {.align = best.align});
  CHECK_TRUE(carried.found);
  double sum_mm = 0;
  for (const cloud::LinePoint& point : carried.carried.line.points)
    sum_mm += test::distance_mm(point.position, upper.line);
  // A straight law, so that lasts and the law's own doubt alone are left: some hundredths.
  CHECK_COMPARE(sum_mm / static_cast<double>(carried.carried.line.points.size()), <, 0.15);
}

TEST(IdentifySizes, TheMatchHasTheModelsLineOnTheUpper) {
  teach_runner();
  const SampleFiles upper = upper_of_size(runner(), 42, true);
  const Result<Identification> sut = identify(library, upper.cloud);
  SUCCEEDS(sut);
  const cloud::ClosedLine& line = sut->matches.front().line;
  CHECK_FALSE(line.points.empty());
  // In the sample's groove, up to 2.5 mm deep, which the upper has not.
  for (const cloud::LinePoint& point : line.points)
    CHECK_COMPARE(test::distance_mm(point.position, upper.line), <, 2.5);
}

TEST(IdentifySizes, WithoutATaughtSizeOnlyItsOwnIsServed) {
  ModelMade made;
  made.foot = "left";
  teach("runner", sample_of(runner(), 39), made);
  const Result<Identification> sut = identify(library, upper_of_size(runner(), 42, false).cloud);
  SUCCEEDS(sut);
  CHECK_TRUE(sut->name.empty());
  CHECK(sut->refusal->code == Refused::NoModelFits);
}

TEST(IdentifySizes, OneSampleOfAKnownSizeServesOthersByTheUsualLaw) {
  teach("runner", sample_of(runner(), 43), left("", "EU 43"));
  const Result<Identification> sut = identify(library, upper_of_size(runner(), 42, false).cloud);
  SUCCEEDS(sut);
  STRCMP_EQUAL("runner", sut->name.c_str());
  STRCMP_EQUAL("EU 42", sut->matches.front().size.c_str());
  DOUBLES_EQUAL(0, sut->matches.front().align.law.taught_at, 0);
}

TEST(IdentifySizes, ModelsAreToldApartInOtherSizesToo) {
  teach_runner();
  teach("court-40", sample_of(court(), 40), left("court", "EU 40"));
  for (const auto& [model, name] : {std::pair{&runner(), "runner"}, std::pair{&court(), "court"}}) {
    const Result<Identification> sut = identify(library, upper_of_size(*model, 41, true).cloud);
    SUCCEEDS(sut);
    STRCMP_EQUAL(name, sut->matches.front().model.c_str());
    STRCMP_EQUAL("right", sut->matches.front().foot.c_str());
    CHECK_FALSE(sut->name.empty());
  }
}

TEST(IdentifySizes, AnOrderThatTheShapeIsNotIsToldAndNothingIsNamed) {
  teach_runner();
  teach("court-40", sample_of(court(), 40), left("court", "EU 40"));
  const cloud::PointCloud upper = upper_of_size(runner(), 39, true).cloud;
  struct Case {
    ModelOrder order;
    const char* words;
  };
  for (const auto& [order, words] :
       {Case{{.model = "runner", .foot = "left", .size = "EU 39"}, "a left shoe was ordered"},
        Case{{.model = "runner", .foot = "right", .size = "EU 40"}, "EU 40 was ordered"},
        Case{{.model = "runner", .foot = "right", .size = "EU 39 1/2"}, "EU 39 1/2 was ordered"},
        Case{{.model = "court"}, "court was ordered, and the upper is none; it looks like runner"}}) {
    const Result<Identification> sut = identify(library, upper, order);
    SUCCEEDS(sut);
    CHECK_TRUE(sut->name.empty());
    CHECK(sut->refusal->code == Refused::OrderDisagrees);
    STRCMP_CONTAINS(words, sut->refusal->reason.c_str());
  }
  const Result<Identification> right =
      identify(library, upper, {.model = "runner", .foot = "right", .size = "EU 39"});
  SUCCEEDS(right);
  STRCMP_EQUAL("runner-39", right->name.c_str());
}

TEST(IdentifySizes, AnOrderOfAModelThatNobodyHasTaughtFails) {
  teach_runner();
  FAILS_NAMING(Errc::FileNotFound, "no model boot",
               identify(library, upper_of_size(runner(), 39, true).cloud, {.model = "boot"}));
}

TEST(IdentifySizes, TwoSamplesTeachOnceAndTheNoteSaysTheSame) {
  teach_runner();
  const ShapeStore sut{library};
  const Result<std::optional<TaughtGrading>> first = sut.grading_of("runner-39", "runner-43", false);
  SUCCEEDS(first);
  CHECK_TRUE(first->has_value());
  CHECK_TRUE(std::filesystem::exists(library.folder() / ".shapes" / "runner-39+runner-43"));
  const Result<std::optional<TaughtGrading>> again = sut.grading_of("runner-39", "runner-43", false);
  SUCCEEDS(again);
  DOUBLES_EQUAL((*first)->between.length, (*again)->between.length, 0);
  DOUBLES_EQUAL((*first)->law.height.bend, (*again)->law.height.bend, 0);
}

TEST(IdentifySizes, TwoSamplesOfTwoModelsTeachNothing) {
  teach("runner-39", sample_of(runner(), 39), left("mixed", "EU 39"));
  teach("court-43", sample_of(court(), 43), left("mixed", "EU 43"));
  const Result<std::optional<TaughtGrading>> sut =
      ShapeStore{library}.grading_of("runner-39", "court-43", false);
  SUCCEEDS(sut);
  CHECK_FALSE(sut->has_value());
}

}  // namespace biteline::transfer
