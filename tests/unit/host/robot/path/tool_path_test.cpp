// SPDX-License-Identifier: MIT
#include "host/robot/path/tool_path.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/transforms.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {
namespace {

Process process_with(const TipPlacement& placement) {
  Process process;
  process.placement = placement;
  return process;
}

std::vector<ToolPoint> on_line(const ToolPath& path) {
  std::vector<ToolPoint> out;
  for (const ToolPoint& p : path.points) {
    if (p.segment == Segment::Line) out.push_back(p);
  }
  return out;
}

}  // namespace

TEST_GROUP(ToolPath) {
  cloud::ClosedLine line = test::made_line();
};

TEST(ToolPath, LevelToolWithoutOffsetsStandsOnTheLineAgainstTheNormal) {
  const ToolPath path = make_tool_path(line, process_with({}), 0);
  const std::vector<ToolPoint> points = on_line(path);
  for (const ToolPoint& p : points) {
    DOUBLES_EQUAL(0.0, (p.T_base_tcp.translation() - p.line_base).norm(), 1e-9);
    DOUBLES_EQUAL(1.0, p.T_base_tcp.linear().determinant(), 1e-9);
    // Level and inward: towards the middle of the oval.
    CHECK(std::abs(p.T_base_tcp.linear()(2, 2)) < 0.05);
    CHECK(p.T_base_tcp.linear().col(2).dot(Vec3{540, -60, 85} - p.line_base) > 0);
  }
  // x goes with the travel.
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    CHECK(points[i].T_base_tcp.linear().col(0).dot(points[i + 1].line_base - points[i].line_base) > 0);
  }
}

TEST(ToolPath, OffsetsTiltAndLeadAreWhatTheyAreNamed) {
  // On a circle all points are alike; the asymmetric numbers tell every axis and sign apart.
  const cloud::ClosedLine circle =
      test::made_line({.half_length_mm = 100, .half_width_mm = 100, .middle = {0, 0, 50}, .rise_mm = 0});
  const TipPlacement placement{
      .outward_mm = 3, .up_mm = 5, .standoff_mm = 20, .tilt_rad = 0.6, .lead_rad = 0.2};
  for (const ToolPoint& p : on_line(make_tool_path(circle, process_with(placement), 0))) {
    const Vec3 out = Vec3{p.line_base.x(), p.line_base.y(), 0}.normalized();
    const Vec3 travel = Vec3::UnitZ().cross(out);
    const Vec3 z = p.T_base_tcp.linear().col(2);
    constexpr double k_tol = 2e-3;  // chords of a sampled circle
    DOUBLES_EQUAL(std::sin(0.2), z.dot(travel), k_tol);
    DOUBLES_EQUAL(-std::cos(0.2) * std::sin(0.6), z.z(), k_tol);
    DOUBLES_EQUAL(-std::cos(0.2) * std::cos(0.6), z.dot(out), k_tol);
    const Vec3 tip = p.T_base_tcp.translation() + 20 * z;  // back onto the offset line
    DOUBLES_EQUAL(3.0, (tip - p.line_base).dot(out), 0.05);
    DOUBLES_EQUAL(5.0, (tip - p.line_base).z(), 0.05);
  }
}

TEST(ToolPath, LeaningNormalsTurnTheToolOnlyWhenAskedFor) {
  cloud::ClosedLine leaning = line;
  for (cloud::LinePoint& p : leaning.points) p.normal = (p.normal - 0.4 * Vec3::UnitZ()).normalized();
  const Process level = process_with({.tilt_rad = 0.5});
  const Process normal = process_with({.outwards = Outwards::Normal, .tilt_rad = 0.5});
  const ToolPath plain = make_tool_path(line, level, 50), kept = make_tool_path(leaning, level, 50);
  const ToolPath turned = make_tool_path(leaning, normal, 50);
  for (std::size_t i = 0; i < plain.points.size(); i += 20) {
    TRANSFORMS_EQUAL(plain.points[i].T_base_tcp, kept.points[i].T_base_tcp, 1e-9, 1e-9);
  }
  // Down by atan 0.4: the tool looks up from lower.
  const auto elevation_rad = [](const ToolPoint& p) { return std::asin(-p.T_base_tcp.linear()(2, 2)); };
  DOUBLES_EQUAL(0.5 - std::atan(0.4), elevation_rad(on_line(turned)[100]), 0.02);
}

TEST(ToolPath, GoesOnceRoundAndOverlaps) {
  Process process;
  process.motion.overlap_mm = 25;
  const std::vector<ToolPoint> points = on_line(make_tool_path(line, process, 100));
  DOUBLES_EQUAL(cloud::length_mm(line) + 25, points.back().arc_mm - points.front().arc_mm, 1.0);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double step_mm = points[i + 1].arc_mm - points[i].arc_mm;
    CHECK(step_mm > process.motion.blend_mm / 0.49 && step_mm < 1.3 * process.motion.spacing_mm);
  }
  DOUBLES_EQUAL(0.0, (points.front().line_base - line.points[100].position).norm(), 2.0);
}

TEST(ToolPath, ApproachesAlongTheAxisAndFromAbove) {
  Process process;
  process.placement.tilt_rad = 1;
  process.motion.draw_back_mm = 15;
  const ToolPath path = make_tool_path(line, process, 0);
  const auto first =
      std::ranges::find_if(path.points, [](const ToolPoint& p) { return p.segment == Segment::Line; });
  CHECK(first != path.points.begin());
  const Vec3 contact = first->T_base_tcp.translation();
  const Vec3 before = contact - (process.motion.approach_mm + process.motion.draw_back_mm) *
                                    first->T_base_tcp.linear().col(2);
  const Vec3 high = before + Vec3{0, 0, process.motion.lift_mm};
  DOUBLES_EQUAL(0.0, (path.points.front().T_base_tcp.translation() - high).norm(), 1e-9);
  CHECK(path.points.front().segment == Segment::Approach);
  CHECK(path.points.back().segment == Segment::Retreat);

  // Farther back along the same axis; away from the line as ever.
  const ToolPath farther = make_tool_path(line, process, 0, 20);
  const Vec3 higher = high - 20 * first->T_base_tcp.linear().col(2);
  DOUBLES_EQUAL(0.0, (farther.points.front().T_base_tcp.translation() - higher).norm(), 1e-9);
  TRANSFORMS_EQUAL(path.points.back().T_base_tcp, farther.points.back().T_base_tcp, 1e-9, 1e-9);
}

TEST(ToolPath, IsEquivariantUnderTurningTheShoe) {
  const SE3 T =
      geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{0.7, Vec3::UnitZ()}}, Vec3{40, -30, 12});
  cloud::ClosedLine moved = line;
  for (cloud::LinePoint& p : moved.points) {
    p.position = T * p.position;
    p.normal = T.linear() * p.normal;
    p.tangent = T.linear() * p.tangent;
  }
  const Process process = process_with({.outward_mm = 1, .up_mm = 2, .tilt_rad = 0.5, .lead_rad = 0.1});
  const ToolPath a = make_tool_path(line, process, 50), b = make_tool_path(moved, process, 50);
  CHECK_EQUAL(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); i += 20)
    TRANSFORMS_EQUAL(T * a.points[i].T_base_tcp, b.points[i].T_base_tcp, 1e-6, 1e-8);
}

TEST(ToolPath, TipThatStandsOffGoesFasterRoundTheToeThanItsPlaceOnTheLine) {
  const auto ratios = [&](const TipPlacement& placement) {
    double most = 0, least = 1e9;
    for (const ToolPoint& point : on_line(make_tool_path(line, process_with(placement), 50))) {
      most = std::max(most, point.speed_ratio);
      least = std::min(least, point.speed_ratio);
    }
    return std::pair{least, most};
  };
  // The oval's ends have a radius of 55^2 / 135 = 22 mm, its sides one of 331 mm: 60 mm farther out.
  const auto [side, toe] = ratios({.standoff_mm = 60});
  DOUBLES_EQUAL((331 + 60) / 331.0, side, 0.08);
  CHECK(toe > 2 && toe <= 3);
  const auto [least, most] = ratios({});
  DOUBLES_EQUAL(1, least, 0);
  DOUBLES_EQUAL(1, most, 0);
}

TEST(ToolPath, SeamAvoidsToeAndHeel) {
  const std::vector<Seam> seams = seam_candidates(line, {});
  CHECK(seams.size() >= 4 && seams.size() <= 8);
  const ToolPath path = make_tool_path(line, {}, seams.front().arc_mm);
  TRANSFORMS_EQUAL(seams.front().T_base_begins, path.points.front().T_base_tcp, 1e-9, 1e-9);
  const Vec3 entry = on_line(path).front().line_base;
  CHECK(std::abs(entry.x() - 540) < 60);  // the oval reaches 135 mm either way
}

}  // namespace biteline::path
