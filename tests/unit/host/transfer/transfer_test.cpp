// SPDX-License-Identifier: MIT
#include "host/transfer/transfer.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <random>

#include "tests/support/errors.hpp"
#include "tests/support/made_cloud.hpp"
#include "tests/support/made_pair.hpp"
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
  test::check_refusal_table(Refused::NoModelFits);
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

TEST(Transfer, OneSampleServesOtherSizesWithinItsBound) {
  // How a factory grades is not known: by length alone with the sections as they are; all alike; the plan
  // alone, or each axis by a rule of its own.
  struct Row {
    double length_mm;
    bool outline_only;
    Vec3 share;  ///< of the change in length that each axis takes, where not the outline only
    bool is_line{true};
  };
  for (const Row& row : {Row{235, true, {}}, Row{305, true, {}}, Row{235, false, {1, 1, 1}},
                         Row{305, false, {1, 1, 0}}, Row{235, false, {1, 0.7, 0.5}, false}}) {
    const double ratio = row.length_mm / 270;
    sim::ShoeParameters size = sim::draw_shoe(sim::ShoeClass::Deep, 6);
    if (row.outline_only) size.outline.length_mm *= ratio;
    const sim::MadeShoe upper{sim::bare_upper_of(size, 0.15, 9)};
    cloud::ClosedLine truth =
        test::as_line(sim::carried_line(sim::true_line(sim::MadeShoe{size}, 1.0), upper), SE3::Identity());
    cloud::PointCloud cloud = test::scanned(upper.parameters(), SE3::Identity(), k_scan);
    const Vec3 factors = row.outline_only ? Vec3{Vec3::Ones()} : Vec3{Vec3::Ones() + (ratio - 1) * row.share};
    const auto placed = [&](const Vec3& p) { return Vec3{pair.T_base_upper * p.cwiseProduct(factors)}; };
    for (Eigen::Vector3f& p : cloud.points) p = placed(p.cast<double>()).cast<float>();
    for (cloud::LinePoint& p : truth.points) p.position = placed(p.position);
    CHECK_FALSE(transfer_line(sample(), cloud, {}).found);
    const Transfer sut = transfer_line(sample(), cloud, {.align = {.grade = true}});
    if (!row.is_line) {  // a rule of its own for each axis leaves more than a millimetre open
      CHECK(sut.refusal && sut.refusal->code == Refused::TooMuchUnsure);
      CHECK_COMPARE(sut.bound_mm, >, cloud::k_sure_mm);
      continue;
    }
    CHECK_TEXT(sut.found, sut.reason().c_str());
    const double error_mm = mean_error_mm(sut.carried.line, truth);
    CHECK(error_mm < 0.4);  // the bar
    CHECK(error_mm < sut.bound_mm);
  }
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
