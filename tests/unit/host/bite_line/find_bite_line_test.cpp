// SPDX-License-Identifier: MIT
// Made shoes with an exactly known line, from the cloud to the line.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/line_stages.hpp"
#include "host/bite_line/live_scan.hpp"
#include "tests/support/made_cloud.hpp"

namespace biteline::bite_line {
namespace {

using test::mean_error_mm;
using test::somewhere;
using Made = test::MadeCloud;

constexpr double k_right_mm = 0.08;

/// Of 30 mm round a shoe or a thing that stands at `T_base_shoe`: the plate under it, every half millimetre.
void add_plate(cloud::PointCloud& cloud, const sim::MadeShoe& shoe, const SE3& T_base_shoe) {
  constexpr double k_step_mm = 0.5;
  for (double s_mm = 0; s_mm < shoe.perimeter_mm(); s_mm += k_step_mm) {
    const sim::Section section = shoe.section(s_mm);
    const Vec3 foot = section.point(section.bottom_z_mm());
    const Vec2 outward = shoe.outline().at(s_mm).normal;
    for (double t_mm = k_step_mm; t_mm < 30; t_mm += k_step_mm) {
      const Vec3 place{foot.x() + t_mm * outward.x(), foot.y() + t_mm * outward.y(), 0};
      cloud.points.push_back((T_base_shoe * place).cast<float>());
    }
  }
  cloud.profile.clear();
}

}  // namespace

TEST_GROUP(FindBiteLine){};

TEST(FindBiteLine, LinesOfMadeShoesAreRight) {
  for (const auto shoe_class : {sim::ShoeClass::Deep, sim::ShoeClass::Shallow, sim::ShoeClass::Step,
                                sim::ShoeClass::Decorated, sim::ShoeClass::Stitched}) {
    const Made made = test::made_cloud(shoe_class, 41, somewhere());
    const Extraction sut = find_bite_line(made.cloud, {});
    const std::string name{sim::name_of(shoe_class)};
    CHECK_TEXT(sut.found, (name + ": " + sut.reason()).c_str());
    CHECK_TEXT(mean_error_mm(sut.line, made.truth) <= k_right_mm, name.c_str());
    CHECK(sut.confidence > 0.5);
  }
}

TEST(FindBiteLine, TheLineIsClosedEvenAndRunsAnticlockwiseWithOutwardNormals) {
  const Made made = test::made_cloud(sim::ShoeClass::Deep, 42, somewhere());
  const Extraction sut = find_bite_line(made.cloud, {});
  CHECK(sut.found);
  const auto& points = sut.line.points;
  Vec3 middle = Vec3::Zero();
  for (const auto& p : points) middle += p.position / static_cast<double>(points.size());
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    const auto& next = points[(i + 1) % points.size()];
    DOUBLES_EQUAL(0.5, (next.position - p.position).norm(), 0.02);
    DOUBLES_EQUAL(1.0, p.normal.norm(), 1e-9);
    DOUBLES_EQUAL(1.0, p.tangent.norm(), 1e-9);
    CHECK(p.confidence >= 0 && p.confidence <= 1);
    area += 0.5 * ((p.position - middle).x() * (next.position - middle).y() -
                   (p.position - middle).y() * (next.position - middle).x());
    // Outwards is to the right of an anticlockwise way.
    const Vec3 right_of_way{p.tangent.y(), -p.tangent.x(), 0};
    CHECK(right_of_way.dot(p.normal) > 0.5);
  }
  CHECK(area > 0);
}

TEST(FindBiteLine, ABareUpperIsRefusedWithAReason) {
  const Extraction sut = find_bite_line(test::made_cloud(sim::ShoeClass::Bare, 43, somewhere()).cloud, {});
  CHECK_FALSE(sut.found);
  STRCMP_CONTAINS("no crease", sut.reason().c_str());
  CHECK(sut.line.points.empty());
  CHECK(sut.confidence < 0.5);
}

TEST(FindBiteLine, AnUpperWithASeamAllTheWayRoundIsRefusedAndTheSameShoeWithASoleIsNot) {
  sim::ShoeParameters shoe = sim::draw_shoe(sim::ShoeClass::Shallow, 62);
  shoe.upper.parallel_seams = {{.u_mm = 11, .depth_mm = 0.4, .width_mm = 0.5}};
  const Extraction with_sole = find_bite_line(test::made_cloud(shoe, somewhere()).cloud, {});
  CHECK_TEXT(with_sole.found, with_sole.reason().c_str());
  DOUBLES_EQUAL(shoe.groove.line_height_mm, with_sole.candidates.front().mean_height_mm, 5.0);
  const Extraction upper =
      find_bite_line(test::made_cloud(sim::bare_upper_of(shoe, 0.15, 3), somewhere()).cloud, {});
  CHECK_FALSE(upper.found);
  STRCMP_CONTAINS("within one surface", upper.reason().c_str());
  CHECK(upper.confidence < 0.5);
}

TEST(FindBiteLine, WhatIsNoShoeIsRefused) {
  std::mt19937 random{1};
  std::normal_distribution<float> normal;
  cloud::PointCloud ball;
  for (int i = 0; i < 30000; ++i)
    ball.points.emplace_back(60 *
                             Eigen::Vector3f{normal(random), normal(random), normal(random)}.normalized());
  const Extraction sut = find_bite_line(ball, {});
  CHECK_FALSE(sut.found);
  STRCMP_CONTAINS("not a shoe", sut.reason().c_str());

  cloud::PointCloud few;
  few.points.resize(12, Eigen::Vector3f::Zero());
  CHECK_FALSE(find_bite_line(few, {}).found);
  CHECK_FALSE(find_bite_line(cloud::PointCloud{}, {}).found);
}

TEST(FindBiteLine, WhereAThingMeetsThePlateItStandsOnIsNoBiteLine) {
  // A slide has a shoe's outline, and its side goes up from the plate as an upper does from a sole.
  const sim::ShoeParameters parameters =
      sim::draw_shoe(sim::ShoeClass::Slide, 46, sim::length_of_size_mm(45));
  Made slide = test::made_cloud(parameters, somewhere());
  add_plate(slide.cloud, sim::MadeShoe{parameters}, somewhere());
  const Extraction none = find_bite_line(slide.cloud, {});
  CHECK_FALSE(none.found);
  const Refused why = none.refusal->code;
  CHECK_TEXT(why == Refused::NoSole || why == Refused::NoCreaseAllRound, none.reason().c_str());

  const sim::ShoeParameters deep = sim::draw_shoe(sim::ShoeClass::Deep, 46, sim::length_of_size_mm(42));
  Made shoe = test::made_cloud(deep, somewhere());
  add_plate(shoe.cloud, sim::MadeShoe{deep}, somewhere());
  const Extraction line = find_bite_line(shoe.cloud, {});
  CHECK_TEXT(line.found, line.reason().c_str());
  CHECK(mean_error_mm(line.line, shoe.truth) <= k_right_mm);
}

TEST(FindBiteLine, TurningTheShoeTurnsTheLine) {
  const Made here = test::made_cloud(sim::ShoeClass::Step, 44, SE3::Identity());
  const Made there = test::made_cloud(sim::ShoeClass::Step, 44, somewhere());
  const Extraction a = find_bite_line(here.cloud, {});
  const Extraction b = find_bite_line(there.cloud, {});
  CHECK(a.found && b.found);
  const SE3 T_back = somewhere().inverse();
  std::vector<Vec3> back;
  for (const auto& p : b.line.points) back.push_back(T_back * p.position);
  CHECK(mean_error_mm(a.line, back) < 0.02);
}

TEST(FindBiteLine, NormalsFollowStitchesAndKeepTheirDirectionAcrossAHole) {
  // What the product promises; without the splines stitches alone make 1.2 to 1.6 degrees.
  constexpr double k_normal_deg = 1.0;
  for (const bool hole : {false, true}) {
    const sim::MadeShoe shoe{sim::draw_shoe(hole ? sim::ShoeClass::Deep : sim::ShoeClass::Stitched, 4)};
    const auto truth = sim::true_line(shoe, 0.1);
    cloud::PointCloud cloud;
    const sim::ScannedCloud scan = sim::scan_quickly(shoe, {}, SE3::Identity());
    const Vec3 centre = truth[truth.size() / 2].point_shoe;  // the toe, where the outline turns
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (hole && (scan.points[i].cast<double>() - centre).head<2>().norm() < 10) continue;
      cloud.points.push_back(scan.points[i]);
      cloud.profile.push_back(scan.profile[i]);
    }
    const Extraction sut = find_bite_line(cloud, {});
    CHECK_TEXT(sut.found, sut.reason().c_str());
    double squares = 0;
    for (const cloud::LinePoint& point : sut.line.points) {
      const auto& near = *std::min_element(truth.begin(), truth.end(), [&](const auto& a, const auto& b) {
        return (a.point_shoe - point.position).squaredNorm() < (b.point_shoe - point.position).squaredNorm();
      });
      squares +=
          (point.normal - near.normal_shoe).squaredNorm() / static_cast<double>(sut.line.points.size());
    }
    CHECK_COMPARE(std::sqrt(squares) * 180 / M_PI, <=, k_normal_deg);
  }
}

TEST(FindBiteLine, AMissingSectorIsBridgedAndMarked) {
  Made made = test::made_cloud(sim::ShoeClass::Deep, 45, somewhere());
  const Vec3 centre = made.truth[made.truth.size() / 4];  // a long side
  std::erase_if(made.cloud.points,
                [&](const Eigen::Vector3f& p) { return (p.cast<double>() - centre).head<2>().norm() < 18; });
  const Extraction sut = find_bite_line(made.cloud, {});
  CHECK_TEXT(sut.found, sut.reason().c_str());
  DOUBLES_EQUAL(36.0, sut.bridged_mm, 6.0);
  const auto away_mm = [&](const cloud::LinePoint& p) { return (p.position - centre).head<2>().norm(); };
  double least_seen = 1;
  for (const auto& p : sut.line.points) {
    if (away_mm(p) > 30) least_seen = std::min(least_seen, p.confidence);
  }
  CHECK_COMPARE(least_seen, >, 0.9);
  for (const auto& p : sut.line.points) {
    if (away_mm(p) < 6) CHECK_COMPARE(p.confidence, <, least_seen);  // straight there: a good guess
  }
}

TEST(FindBiteLine, ARefusalSaysWhichGateFailedByHowMuchAndWhere) {
  Made made = test::made_cloud(sim::ShoeClass::Deep, 45, somewhere());
  const Vec3 centre = made.truth[made.truth.size() / 4];
  constexpr double k_hole_mm = 45;
  const auto away_mm = [&](const Vec3& p) { return (p - centre).head<2>().norm(); };
  std::erase_if(made.cloud.points,
                [&](const Eigen::Vector3f& p) { return away_mm(p.cast<double>()) < k_hole_mm; });
  const Extraction sut = find_bite_line(made.cloud, {});
  CHECK(sut.verdict() == Verdict::Refused);
  CHECK_TEXT(sut.refusal->code == Refused::TooMuchMissing, sut.reason().c_str());
  const auto gate = std::ranges::find(sut.gates, std::string{"longest_unseen_mm"},
                                      [](const SeenGate& one) { return std::string{one.measure}; });
  CHECK(gate != sut.gates.end());
  CHECK(gate->at_most);
  CHECK_COMPARE(gate->value, >, gate->limit);
  CHECK_COMPARE(gate->sure, <, 0.5);
  // The hole is 90 mm wide, and is taken for what it is.
  DOUBLES_EQUAL(2 * k_hole_mm, gate->value, 12.0);
  const Candidate& best = sut.candidates.front();
  LONGS_EQUAL(best.points.size(), best.lacks.size());
  const std::uint8_t surface = lack_of(Refused::TooMuchMissing);
  for (std::size_t i = 0; i < best.points.size(); ++i) {
    // What is put in the place of the hole lies near where the shoe was: by its edge it may be either.
    if (away_mm(best.points[i]) > k_hole_mm + 10) CHECK((best.lacks[i] & surface) == 0);
    if (away_mm(best.points[i]) < k_hole_mm - 15) CHECK((best.lacks[i] & surface) != 0);
  }
}

TEST(FindBiteLine, StraysInARowDoNotDrawTheLineOutwards) {
  Made made = test::made_cloud(sim::ShoeClass::Deep, 46, somewhere());
  // From the line's farthest place 20 mm outwards, a point every 2 mm.
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : made.truth) middle += p / static_cast<double>(made.truth.size());
  const Vec3 tip = *std::max_element(made.truth.begin(), made.truth.end(), [&](const Vec3& a, const Vec3& b) {
    return (a - middle).norm() < (b - middle).norm();
  });
  for (double out_mm = 2; out_mm <= 20; out_mm += 2)
    made.cloud.points.push_back((tip + out_mm * (tip - middle).normalized()).cast<float>());
  made.cloud.profile.clear();
  made.cloud.column.clear();
  const Extraction sut = find_bite_line(made.cloud, {});
  CHECK_TEXT(sut.found, sut.reason().c_str());
  for (const cloud::LinePoint& point : sut.line.points)
    CHECK(test::distance_mm(point.position, made.truth) < 0.5);
}

TEST(FindBiteLine, TheLineWhileScanningIsThatOfTheFinishedCloud) {
  const Made made = test::made_cloud(sim::ShoeClass::Faded, 47, somewhere());
  LiveScan sut;
  const auto& profile = made.cloud.profile;
  for (std::size_t first = 0; first < profile.size();) {
    std::size_t end = first;
    while (end < profile.size() && profile[end] == profile[first]) ++end;
    sut.add_profile(profile[first], {made.cloud.points.data() + first, end - first});
    first = end;
  }
  LONGS_EQUAL(made.cloud.size(), sut.points());
  const Extraction live = sut.finish({});
  CHECK_TEXT(live.found, live.reason().c_str());
  std::vector<Vec3> finished;
  for (const auto& p : find_bite_line(made.cloud, {}).line.points) finished.push_back(p.position);
  CHECK_COMPARE(mean_error_mm(live.line, finished), <=, 0.02);
  CHECK_COMPARE(mean_error_mm(live.line, made.truth), <=, k_right_mm);
}

TEST(FindBiteLine, HalfAScanIsNotYetALine) {
  const Made made = test::made_cloud(sim::ShoeClass::Deep, 48, somewhere());
  LiveScan sut;
  CHECK_FALSE(sut.finish({}).found);
  sut.add_profile(0, {made.cloud.points.data(), made.cloud.size() / 2});
  const Extraction half = sut.finish({});
  CHECK_FALSE(half.found);
  CHECK_FALSE(half.reason().empty());
}

TEST(FindBiteLine, WhatTheStepsHandedOnIsKeptForPictures) {
  const Made made = test::made_cloud(sim::ShoeClass::Deep, 46, somewhere());
  std::optional<Workings> workings;
  const Extraction sut = find_bite_line(made.cloud, {}, &workings);
  CHECK_TEXT(sut.found, sut.reason().c_str());
  CHECK(workings.has_value());
  const LineStages stages = line_stages(*workings);
  LONGS_EQUAL(stages.surface.size(), stages.curvature_per_mm.size());
  LONGS_EQUAL(stages.surface.size(), stages.surface.normals.size());
  CHECK(stages.denoised_points.size() <= stages.feature_points.size());
  LONGS_EQUAL(stages.unrolled.cols, stages.unrolled.path_row.size());
  LONGS_EQUAL(4, stages.unrolled.marks.size());
  // All that was kept lies where the line is.
  CHECK(!stages.coarse_line.empty());
  for (const std::uint32_t i : stages.coarse_line)
    CHECK(test::distance_mm(stages.surface.points[i].cast<double>(), made.truth) < 6.0);
  CHECK(!stages.thinned_line.empty());
  for (const Vec3& p : stages.thinned_line) CHECK(test::distance_mm(p, made.truth) < 1.0);
}

TEST(FindBiteLine, ARefusalKeepsTheStepsItCameTo) {
  std::optional<Workings> workings;
  const Extraction sut =
      find_bite_line(test::made_cloud(sim::ShoeClass::Bare, 43, somewhere()).cloud, {}, &workings);
  CHECK_FALSE(sut.found);
  CHECK(workings.has_value());
  const LineStages stages = line_stages(*workings);
  CHECK(!stages.surface.points.empty());
  CHECK(stages.coarse_line.empty());
  CHECK(stages.thinned_line.empty());
  CHECK(stages.unrolled.path_row.empty());
  LONGS_EQUAL(sut.candidates.size(), stages.unrolled.rival_rows.size());
}

}  // namespace biteline::bite_line
