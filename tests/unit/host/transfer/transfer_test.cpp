// SPDX-License-Identifier: MIT
#include "host/transfer/transfer.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <random>

#include "host/transfer/grading.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_cloud.hpp"
#include "tests/support/made_pair.hpp"
#include "tests/support/made_sizes.hpp"
#include "tests/support/refusals.hpp"

namespace biteline::transfer {
namespace {

const sim::ScanSettings k_scan{.profile_step_mm = 1.2, .column_step_mm = 0.2};

double mean_error_mm(const cloud::ClosedLine& line, const cloud::ClosedLine& truth) {
  double sum_mm = 0;
  for (const cloud::LinePoint& p : line.points) {
    double best = 1e9;
    for (std::size_t i = 0; i < truth.points.size(); ++i) {
      const Vec3 a = truth.points[i].position, d = truth.points[(i + 1) % truth.points.size()].position - a;
      const double share = std::clamp((p.position - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
      best = std::min(best, (a + share * d - p.position).norm());
    }
    sum_mm += best;
  }
  return sum_mm / static_cast<double>(line.points.size());
}

double normal_rms_deg(const cloud::ClosedLine& line, const cloud::ClosedLine& truth) {
  double sum = 0;
  for (const cloud::LinePoint& p : line.points) {
    const auto nearest = std::min_element(
        truth.points.begin(), truth.points.end(), [&](const cloud::LinePoint& a, const cloud::LinePoint& b) {
          return (a.position - p.position).squaredNorm() < (b.position - p.position).squaredNorm();
        });
    const double angle_deg = std::acos(std::min(1.0, p.normal.dot(nearest->normal))) * 180 / 3.14159265358979;
    sum += angle_deg * angle_deg;
  }
  return std::sqrt(sum / static_cast<double>(line.points.size()));
}

const test::MadePair& the_pair() {
  static const test::MadePair pair = test::made_pair({.seed = 6, .scan = k_scan});
  return pair;
}

}  // namespace

TEST_GROUP(Transfer) {
  const test::MadePair& pair = the_pair();
  SampleFiles sample() const {
    return {.cloud = pair.sample_cloud, .line = pair.sample_line};
  }
};

TEST(Transfer, TheUpperGetsTheSamplesLineAtItsHeight) {
  const Transfer sut = transfer_line(sample(), pair.upper_cloud, {});
  CHECK(sut.found);
  CHECK(sut.from_mesh);
  // The bars for a recorded pair; made without the errors of peaks and poses it must be well inside.
  CHECK(mean_error_mm(sut.carried.line, pair.upper_line) < 0.05);
  CHECK(normal_rms_deg(sut.carried.line, pair.upper_line) < 1.5);
  CHECK(sut.confidence > 0.9);
  CHECK(sut.bound_mm < 0.5);
}

TEST(Transfer, ScatteredPointsWillDo) {
  cloud::PointCloud scattered;
  scattered.points = pair.upper_cloud.points;
  std::mt19937_64 random{5};
  std::shuffle(scattered.points.begin(), scattered.points.end(), random);
  const Transfer sut = transfer_line(sample(), scattered, {});
  CHECK(sut.found);
  CHECK_FALSE(sut.from_mesh);
  CHECK(mean_error_mm(sut.carried.line, pair.upper_line) < 0.05);
}

TEST(Transfer, EveryRefusalHasItsRow) {
  test::check_refusal_table(Refused::OrderDisagrees);
}

TEST(Transfer, ARefusalHasItsReasonAndNoLine) {
  const test::MadePair other = test::made_pair({.seed = 8, .scan = k_scan});
  const Transfer sut = transfer_line(sample(), other.upper_cloud, {});
  CHECK_FALSE(sut.found);
  CHECK(sut.refusal->code == Refused::OtherModel);
  STRCMP_CONTAINS("another model", sut.reason().c_str());
  CHECK(sut.carried.line.points.empty());
}

TEST(Transfer, AnUpperThatIsPushedWhileItIsScannedGetsNoLine) {
  // Twice the limit and a little more.  Two ways at right angles: one of them is not along the wall at the
  // seam.
  int refused = 0;
  for (const Eigen::Vector3f& by_mm : {Eigen::Vector3f{1.5F, 0, 0}, Eigen::Vector3f{0, 1.5F, 0}}) {
    const Transfer sut = transfer_line(sample(), test::pushed(pair.upper_cloud, 0.5, by_mm), {});
    if (sut.refusal && sut.refusal->code == Refused::DoesNotClose) ++refused;
  }
  CHECK_COMPARE(refused, >=, 1);
  // Ten times a sound scan's, a tenth of the limit's twofold.
  DOUBLES_EQUAL(0, transfer_line(sample(), pair.upper_cloud, {}).seam.value().moved_mm, 0.1);
}

TEST(Transfer, OneSampleServesTheNextSizesWithinItsBound) {
  // How the factory grades is not known: its law lies somewhere about the usual one.
  const test::FactoryLaw law{.width = {.share = 0.9}, .height = {.share = 0.4}};
  const test::MadeModel model{sim::ShoeClass::Deep, 6, law, k_scan};
  const ReadySample one{model.sample(0)};
  for (const double change : {-0.025, 0.025}) {
    const SampleFiles upper = model.upper(change, false, 9, pair.T_base_upper);
    CHECK_FALSE(transfer_line(one, upper.cloud, {}).found);
    const Transfer sut = transfer_line(one, upper.cloud, {.align = {.grade = true}});
    CHECK_TEXT(sut.found, sut.reason().c_str());
    CHECK_COMPARE(mean_error_mm(sut.carried.line, upper.line), <, sut.bound_mm);
    CHECK_COMPARE(sut.bound_mm, <, cloud::k_sure_mm);
  }
  // Four sizes away nobody knows enough.
  const SampleFiles far = model.upper(0.1, false, 9, pair.T_base_upper);
  const Transfer sut = transfer_line(one, far.cloud, {.align = {.grade = true}});
  CHECK(sut.refusal && sut.refusal->code == Refused::TooMuchUnsure);
  CHECK_COMPARE(sut.bound_mm, >, cloud::k_sure_mm);
}

TEST(Transfer, TwoSamplesTeachHowTheirFactoryGrades) {
  // Its heights do not grow in a line: over a tenth they take 30 % less than that.
  const test::FactoryLaw law{.width = {.share = 0.65}, .height = {.share = 0.6, .bend = -3}};
  const test::MadeModel model{sim::ShoeClass::Deep, 6, law, k_scan};
  constexpr double k_small = -0.05, k_large = 0.05;
  const ReadySample small{model.sample(k_small)}, large{model.sample(k_large)};
  const Result<TaughtGrading> taught = teach_grading(*small.prepared(), *large.prepared());
  SUCCEEDS(taught);
  const auto share = [&](const test::FactoryLaw::Rule& rule) {
    return (rule.at(k_large) / rule.at(k_small) - 1) / ((1 + k_large) / (1 + k_small) - 1);
  };
  // 0.02: a fifth of a millimetre over a tenth more length, at 100 mm.
  DOUBLES_EQUAL(share(law.width), taught->law.width.mean, 0.02);
  DOUBLES_EQUAL(share(law.height), taught->law.height.mean, 0.02);

  for (const double change : {-0.1, 0.0, 0.1}) {
    const bool other_foot = change > 0;
    const SampleFiles upper = model.upper(change, other_foot, 9, pair.T_base_upper);
    const Result<Transfer> sut =
        transfer_by_two({&small, &large}, upper.cloud, {.align = {.mirror = other_foot}});
    SUCCEEDS(sut);
    CHECK_TEXT(sut->found, sut->reason().c_str());
    CHECK_COMPARE(mean_error_mm(sut->carried.line, upper.line), <, sut->bound_mm);
    CHECK_COMPARE(sut->bound_mm, <, cloud::k_sure_mm);
    // By the nearer one.
    CHECK_COMPARE(std::abs(sut->alignment.placement.grade.length - 1), <, 0.06);
  }
}

TEST(Transfer, SamplesOfOneSizeOrOfTwoModelsTeachNothing) {
  const test::MadeModel model{sim::ShoeClass::Deep, 6, {}, k_scan},
      other{sim::ShoeClass::Deep, 8, {}, k_scan};
  const ReadySample one{model.sample(0)}, same{model.sample(0.005)}, stranger{other.sample(0.05)};
  const Result<TaughtGrading> of_same = teach_grading(*one.prepared(), *same.prepared());
  CHECK(!of_same);
  STRCMP_CONTAINS("nearly one size", to_line(of_same.error()).c_str());
  const Result<TaughtGrading> of_strangers = teach_grading(*one.prepared(), *stranger.prepared());
  CHECK(!of_strangers);
  STRCMP_CONTAINS("no two sizes of one model and foot", to_line(of_strangers.error()).c_str());
}

TEST(Transfer, AMirroredSampleServesTheOtherFoot) {
  // Across the plane y = 0 of base.
  const auto mirrored = [](Vec3 p) { return Vec3{p.x(), -p.y(), p.z()}; };
  cloud::PointCloud other_foot = pair.upper_cloud;
  for (Eigen::Vector3f& p : other_foot.points) p.y() = -p.y();
  cloud::ClosedLine truth = pair.upper_line;
  for (cloud::LinePoint& p : truth.points) {
    p.position = mirrored(p.position);
    p.normal = mirrored(p.normal);
  }
  const Transfer sut = transfer_line(sample(), other_foot, {.align = {.mirror = true}});
  CHECK(sut.found);
  CHECK(mean_error_mm(sut.carried.line, truth) < 0.05);
  CHECK(normal_rms_deg(sut.carried.line, truth) < 1.5);
  double area = 0;
  const std::vector<cloud::LinePoint>& points = sut.carried.line.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 a = points[i].position - points[0].position,
               b = points[(i + 1) % points.size()].position - points[0].position;
    area += a.x() * b.y() - a.y() * b.x();
  }
  CHECK(area > 0);  // anticlockwise, though the sample's own order is turned round by the mirror
}

}  // namespace biteline::transfer
