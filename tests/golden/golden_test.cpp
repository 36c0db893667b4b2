// SPDX-License-Identifier: MIT
// What must come out of the recordings in this folder, which are part of the repository.  Made by the
// simulated cell (make.sh), with its truth.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "host/bite_line/evaluation/cloud_error.hpp"
#include "host/bite_line/evaluation/line_error.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/cloud/ply.hpp"
#include "host/intake/session_run.hpp"
#include "host/robot/path/plan.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/line_distance.hpp"

namespace biteline {
namespace {

namespace fs = std::filesystem;

const fs::path k_golden{BITELINE_GOLDEN};

// What the product promises for a groove that is seen all round, and for an upper whose last differs from the
// sample's by 0.15 mm (docs/line.md, docs/transfer.md).
constexpr double k_line_mean_mm = 0.05, k_line_p95_mm = 0.12, k_line_max_mm = 0.3;
constexpr double k_carried_mean_mm = 0.15, k_carried_p95_mm = 0.35;

cloud::PointCloud cloud_of(const char* part) {
  auto cloud = cloud::read_cloud(k_golden / part / "cloud.ply");
  SUCCEEDS(cloud);
  CHECK(cloud->organised());
  return std::move(*cloud);
}

cloud::ClosedLine truth_of(const char* part) {
  auto line = cloud::read_positions(k_golden / part / "truth/groove.csv");
  SUCCEEDS(line);
  return *line;
}

double table_z_mm(const char* part) {
  std::ifstream file(k_golden / part / "truth/T_base_shoe.txt");
  double z_mm = 0;
  for (int i = 0; i < 12; ++i) file >> z_mm;
  CHECK(file.good());
  return z_mm;
}

/// Found once for all tests.
const bite_line::Extraction& sample_line() {
  static const bite_line::Extraction found = bite_line::find_bite_line(cloud_of("sample"), {});
  return found;
}

}  // namespace

TEST_GROUP(Golden){};

TEST(Golden, ReplayPutsEveryPointOfAPartOfAScanOntoTheTrueSurface) {
  auto run = intake::run_sensor_on_session({.session = k_golden / "part",
                                            .sensor_file = {},
                                            .sensor_options = {},
                                            .program = fs::path{BITELINE_SENSOR},
                                            .progress = {},
                                            .on_profile = {}});
  SUCCEEDS(run);
  LONGS_EQUAL(8, run->counts.profiles);
  LONGS_EQUAL(0, run->counts.profiles_lost);
  CHECK(run->cloud.size() > 8U * 500U);  // a wall of 60 mm at some 0.1 mm a column

  const auto mesh = cloud::read_mesh(k_golden / "part/truth/reference.ply");
  SUCCEEDS(mesh);
  const auto error = evaluation::cloud_error(run->cloud, evaluation::ReferenceSurface{*mesh});
  LONGS_EQUAL(0, error.points_far);
  // Each pose is told with 0.010 mm and 5.2e-5 rad, which are 0.025 mm at 480 mm: together 0.027 mm.  The
  // track averages five of them at least; peaks (0.03 px at 0.16 mm a row) add 0.005 mm.
  const double derived_mm = std::hypot(0.027 / std::sqrt(5.0), 0.005);
  CHECK_COMPARE(error.rms_mm, <=, derived_mm);
  CHECK_COMPARE(std::max(error.max_mm, -error.min_mm), <=, 6 * derived_mm);  // a million points would reach 5
}

TEST(Golden, ExtractFindsTheSamplesLine) {
  const bite_line::Extraction& sut = sample_line();
  CHECK_TEXT(sut.found, sut.reason().c_str());
  const evaluation::LineError error = evaluation::line_error(sut.line, truth_of("sample"));
  CHECK_COMPARE(error.mean_mm, <=, k_line_mean_mm);
  CHECK_COMPARE(error.p95_mm, <=, k_line_p95_mm);
  CHECK_COMPARE(error.max_mm, <=, k_line_max_mm);
  CHECK_COMPARE(error.complete, >=, 0.99);
}

TEST(Golden, ExtractRefusesTheUpper) {
  const bite_line::Extraction sut = bite_line::find_bite_line(cloud_of("upper"), {});
  CHECK_FALSE(sut.found);
  CHECK(sut.line.points.empty());
}

TEST(Golden, TransferGivesTheUpperItsLineWithinItsOwnBound) {
  CHECK(sample_line().found);
  const transfer::SampleFiles sample{.cloud = cloud_of("sample"), .line = sample_line().line};
  const transfer::Transfer sut = transfer::transfer_line(sample, cloud_of("upper"), {});
  CHECK_TEXT(sut.found, sut.reason().c_str());
  const evaluation::LineError error = evaluation::line_error(sut.carried.line, truth_of("upper"));
  CHECK_COMPARE(error.mean_mm, <=, k_carried_mean_mm);
  CHECK_COMPARE(error.p95_mm, <=, k_carried_p95_mm);
  CHECK_COMPARE(error.p95_mm, <=, sut.bound_mm);
}

TEST(Golden, PlanFollowsTheTrueLineAllTheWayRoundAtTheProcesssOffset) {
  const cloud::ClosedLine truth = truth_of("sample");
  CHECK(sample_line().found);
  path::PlanRequest request{.line = sample_line().line,
                            .process = *path::read_process(fs::path{BITELINE_PROCESSES} / "cement.yaml"),
                            .arm = *kinematics::arm_model("UR5e"),
                            .table_z_mm = table_z_mm("sample"),
                            .shoe = {},
                            .cloud = cloud_of("sample").points};
  const path::PlanOutcome sut = path::plan(request);
  CHECK_TEXT(sut.path.has_value(), sut.reason().c_str());
  for (const path::Check& check : sut.checks) CHECK_TEXT(check.passed, check.name.c_str());

  const path::TipPlacement& placement = request.process.placement;
  const double offset_mm = std::hypot(placement.outward_mm, placement.up_mm);
  const double away_mm = offset_mm + placement.standoff_mm;
  double longest_step_mm = 0;
  cloud::ClosedLine followed;
  for (const path::Waypoint& w : sut.path->path().waypoints) {
    if (w.segment != path::Segment::Line) continue;
    CHECK_COMPARE(test::distance_mm(w.line_base, truth), <=, k_line_max_mm);
    CHECK_COMPARE((w.T_base_tcp.translation() - w.line_base).norm(), <=, away_mm + 1e-6);
    if (!followed.points.empty())
      longest_step_mm = std::max(longest_step_mm, (w.line_base - followed.points.back().position).norm());
    followed.points.push_back({.position = w.line_base, .normal = Vec3::Zero(), .tangent = Vec3::Zero()});
  }
  // Straight moves between the targets leave the line by the chord error that the process allows.
  for (const cloud::LinePoint& point : truth.points)
    CHECK_COMPARE(test::distance_mm(point.position, followed), <=,
                  k_line_max_mm + request.process.motion.chord_error_mm);
  CHECK_COMPARE(longest_step_mm, <=, 2 * sut.path->path().motion.spacing_mm);
}

}  // namespace biteline
