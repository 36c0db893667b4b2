// SPDX-License-Identifier: MIT
#include "host/transfer/align/alignment.hpp"

#include <CppUTest/TestHarness.h>

#include <numbers>
#include <random>

#include "host/transfer/align/diagnosis.hpp"
#include "tests/support/made_pair.hpp"

namespace biteline::transfer {
namespace {

// Sparse scans keep the tests fast; at 0.15 mm a rim is still known to 0.1 mm.
const sim::ScanSettings k_scan{.profile_step_mm = 1.2, .column_step_mm = 0.15};

// The two lasts differ by 0.15 mm: no alignment of the whole is nearer to the truth than about that.
constexpr double k_tol_mm = 0.3;

cloud::PointCloud moved(cloud::PointCloud cloud, const Eigen::Affine3d& motion) {
  for (Eigen::Vector3f& p : cloud.points) p = (motion * p.cast<double>()).cast<float>();
  return cloud;
}

const test::MadePair& the_pair() {
  static const test::MadePair pair = test::made_pair({.seed = 3, .scan = k_scan});
  return pair;
}

/// Mean distance of the placed line to where the true poses put it.
double line_error_mm(const test::MadePair& pair, const Sample& sample, const Alignment& alignment,
                     const SE3& T_base_upper) {
  const SE3 T_upper_sample = T_base_upper * pair.T_base_sample.inverse();
  const SE3 T_shoe_base = sample.T_base_shoe.inverse();
  double sum_mm = 0;
  for (const cloud::LinePoint& p : pair.sample_line.points) {
    const Alignment::OnLine placed =
        alignment.placed({.point = T_shoe_base * p.position, .normal = T_shoe_base.linear() * p.normal});
    sum_mm += (placed.point - T_upper_sample * p.position).norm();
  }
  return sum_mm / static_cast<double>(pair.sample_line.points.size());
}

}  // namespace

TEST_GROUP(Alignment) {
  const test::MadePair& pair = the_pair();

  Alignment aligned(const cloud::PointCloud& upper, const AlignOptions& options = {}) const {
    return align(*prepare_sample(pair.sample_cloud, pair.sample_line), *prepare_upper(upper), options);
  }
  Diagnosis diagnosed(const cloud::PointCloud& upper) const {
    const Alignment refused = aligned(upper);
    CHECK(refused.verdict == Verdict::OtherModel);
    return diagnose(*prepare_sample(pair.sample_cloud, pair.sample_line), *prepare_upper(upper), {}, refused);
  }
};

TEST(Alignment, NextUpperOfTheModelIsFound) {
  const Sample sample = *prepare_sample(pair.sample_cloud, pair.sample_line);
  const Alignment sut = align(sample, *prepare_upper(pair.upper_cloud), {});
  CHECK(sut.accepted());
  CHECK(sut.converged);
  CHECK(sut.overlap_ratio > 0.97);
  CHECK(sut.shape_rms_mm < 0.2);
  CHECK(sut.rim_used);
  CHECK(line_error_mm(pair, sample, sut, pair.T_base_upper) < k_tol_mm);
}

TEST(Alignment, AnyPlaceAndYawAndTenDegreesOfTiltEndAlike) {
  const Sample sample = *prepare_sample(pair.sample_cloud, pair.sample_line);
  std::mt19937_64 random{11};
  std::uniform_real_distribution<double> unit{-1, 1};
  for (int i = 0; i < 6; ++i) {
    const double tilt_rad = 10 * std::numbers::pi / 180 * unit(random),
                 yaw_rad = std::numbers::pi * unit(random);
    const Vec3 axis = Vec3{unit(random), unit(random), 0}.normalized();
    const SE3 T_random = geometry::make_se3(
        Eigen::AngleAxisd{tilt_rad, axis} * Eigen::Quaterniond{Eigen::AngleAxisd{yaw_rad, Vec3::UnitZ()}},
        {500 * unit(random), 500 * unit(random), 100 * unit(random)});
    const Alignment sut =
        align(sample, *prepare_upper(moved(pair.upper_cloud, Eigen::Affine3d{T_random.matrix()})), {});
    CHECK(sut.accepted());
    CHECK(line_error_mm(pair, sample, sut, T_random * pair.T_base_upper) < k_tol_mm);
  }
}

TEST(Alignment, AnotherModelIsRefused) {
  // Same size and foot class drawn anew: another outline, another wall.
  const test::MadePair other = test::made_pair({.seed = 9, .scan = k_scan});
  const Diagnosis sut = diagnosed(other.upper_cloud);
  CHECK(sut.verdict == Verdict::OtherModel);
  STRCMP_CONTAINS("another model", sut.reason.c_str());
  STRCMP_CONTAINS("neither mirroring nor another size", sut.reason.c_str());
}

TEST(Alignment, AnotherModelThatDiffersBySmoothBulgesOnlyIsRefused) {
  sim::ShoeParameters upper = sim::bare_upper_of(sim::draw_shoe(sim::ShoeClass::Deep, 3), 0.6, 5);
  const Alignment sut = aligned(test::scanned(upper, pair.T_base_upper, k_scan));
  CHECK_FALSE(sut.accepted());
  CHECK(sut.shape_rms_mm > 0.2);
}

TEST(Alignment, TheOtherFootIsRefusedAndMirroringTakesIt) {
  Eigen::Affine3d mirror = Eigen::Affine3d::Identity();
  mirror.linear()(1, 1) = -1;
  const cloud::PointCloud other_foot = moved(pair.upper_cloud, mirror);
  const Diagnosis sut = diagnosed(other_foot);
  CHECK(sut.verdict == Verdict::OtherFoot);
  CHECK(sut.reason.find("other foot") != std::string::npos);
  CHECK(aligned(other_foot, {.mirror = true}).accepted());
}

TEST(Alignment, AnotherSizeIsRefusedAndGradingTakesIt) {
  for (const double factor : {1.05, 0.95}) {
    Eigen::Affine3d growth = Eigen::Affine3d::Identity();
    growth.linear() *= factor;
    const cloud::PointCloud other_size = moved(pair.upper_cloud, growth);
    const Diagnosis sut = diagnosed(other_size);
    CHECK(sut.verdict == Verdict::OtherSize);
    CHECK(sut.reason.find("another size") != std::string::npos);
    const Alignment graded = aligned(other_size, {.grade = true});
    CHECK(graded.accepted());
    DOUBLES_EQUAL(factor, graded.placement.grade.length, 0.004);
    DOUBLES_EQUAL(factor, graded.placement.grade.width, 0.004);
    // What a wall hardly shows keeps to the usual law: within two of its standard deviations.
    const GradingLaw law = usual_law();
    DOUBLES_EQUAL(factor, graded.placement.grade.height, 2 * law.height.sigma * std::abs(factor - 1));
  }
}

TEST(Alignment, OtherFootAndOtherSizeAtOnceIsToldAsBoth) {
  Eigen::Affine3d both = Eigen::Affine3d::Identity();
  both.linear() = Vec3{1.05, -1.05, 1.05}.asDiagonal();
  const Diagnosis sut = diagnosed(moved(pair.upper_cloud, both));
  CHECK(sut.verdict == Verdict::OtherFoot);
  STRCMP_CONTAINS("other foot and of another size", sut.reason.c_str());
}

TEST(Alignment, AnUpperUpsideDownIsToldAsThat) {
  Eigen::Affine3d over = Eigen::Affine3d::Identity();
  over.linear() = Vec3{1, -1, -1}.asDiagonal();
  const Diagnosis sut = diagnosed(moved(pair.upper_cloud, over));
  CHECK_TEXT(sut.verdict == Verdict::UpsideDown, sut.reason.c_str());
  STRCMP_CONTAINS("upside down", sut.reason.c_str());
}

TEST(Alignment, CollarsThatAreCutElsewhereDoNotLiftTheLine) {
  // Both are cut below their top, aslant: the upper 0.6 mm higher than the sample.
  const auto cut = [](cloud::PointCloud cloud, const SE3& T_base_shoe, double top_mm) {
    cloud::PointCloud kept;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Vec3 p = T_base_shoe.inverse() * cloud.points[i].cast<double>();
      if (p.z() > top_mm - 0.02 * p.x()) continue;
      kept.points.push_back(cloud.points[i]);
      kept.profile.push_back(cloud.profile[i]);
      kept.column.push_back(cloud.column[i]);
    }
    return kept;
  };
  const double top_mm = sim::draw_shoe(sim::ShoeClass::Deep, 3).upper.top_z_mm - 1;
  for (const double higher_mm : {0.0, 0.6}) {
    const Sample sample =
        *prepare_sample(cut(pair.sample_cloud, pair.T_base_sample, top_mm), pair.sample_line);
    const Alignment sut =
        align(sample, *prepare_upper(cut(pair.upper_cloud, pair.T_base_upper, top_mm + higher_mm)), {});
    CHECK_EQUAL(higher_mm == 0, sut.rim_used);
    CHECK_TEXT(sut.accepted() || higher_mm > 0,
               sut.reason.c_str());  // without its collar too little may be left
    if (sut.accepted()) CHECK(line_error_mm(pair, sample, sut, pair.T_base_upper) < k_tol_mm);
  }
}

TEST(Alignment, AThirdOfTheUpperIsTooLittle) {
  cloud::PointCloud part;
  const std::uint32_t last = pair.upper_cloud.profile.back();
  for (std::size_t i = 0; i < pair.upper_cloud.size(); ++i) {
    if (3 * pair.upper_cloud.profile[i] > last) break;
    part.points.push_back(pair.upper_cloud.points[i]);
    part.profile.push_back(pair.upper_cloud.profile[i]);
    part.column.push_back(pair.upper_cloud.column[i]);
  }
  const Alignment sut = aligned(part);
  CHECK(sut.verdict == Verdict::TooLittleOverlap);
  CHECK(sut.reason.find("overlap") != std::string::npos);
}

TEST(Alignment, AnUprightTubeDoesNotFixItsHeight) {
  // An ellipse with upright walls, whose upper end is the view's: it slides up and down.
  cloud::PointCloud tube;
  cloud::ClosedLine line;
  std::mt19937_64 random{17};
  std::normal_distribution<double> noise_mm{0, 0.02};
  for (int i = 0; i < 700; ++i) {
    const double turn_rad = 2 * std::numbers::pi * i / 700;
    const Vec3 outline{130 * std::cos(turn_rad), (45 + 5 * std::cos(turn_rad)) * std::sin(turn_rad), 0};
    for (int k = 0; k < 200; ++k) {
      tube.points.push_back(((1 + noise_mm(random) / 130) * outline + 0.3 * k * Vec3::UnitZ()).cast<float>());
      tube.profile.push_back(static_cast<std::uint32_t>(i));
      tube.column.push_back(static_cast<std::uint16_t>(k));
    }
    line.points.push_back(
        {.position = outline + 10 * Vec3::UnitZ(), .normal = Vec3::UnitX(), .tangent = Vec3::UnitY()});
  }
  const Alignment sut = align(*prepare_sample(tube, line), *prepare_upper(tube), {});
  CHECK(sut.verdict == Verdict::DirectionNotFixed);
  STRCMP_EQUAL("up and down", sut.weakest.words.c_str());
}

TEST(Alignment, NoSurfaceIsRefusedBeforeAnythingElse) {
  cloud::PointCloud specks;
  for (int i = 0; i < 100; ++i) specks.points.emplace_back(10.0F * static_cast<float>(i), 0.0F, 0.0F);
  CHECK_FALSE(prepare_upper(specks).has_value());
}

}  // namespace biteline::transfer
