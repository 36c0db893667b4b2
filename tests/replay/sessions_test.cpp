// SPDX-License-Identifier: MIT
// Recorded and made sessions through the sensor program and the host, against their truth.  Bounds in mm and
// degrees: what the product promises for such sessions, not what it happens to reach.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "host/bite_line/evaluation/cloud_error.hpp"
#include "host/bite_line/evaluation/line_error.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/published/level_set.hpp"
#include "host/intake/session_run.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shape_truth.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline {

namespace fs = std::filesystem;

TEST_GROUP(Sessions){static cloud::PointCloud scan(const fs::path& session){
    auto run = intake::run_sensor_on_session({.session = session,
                                              .sensor_file = {},
                                              .sensor_options = {},
                                              .program = fs::path{BITELINE_SENSOR},
                                              .progress = {},
                                              .on_profile = {}});
SUCCEEDS(run);
LONGS_EQUAL(0, run->counts.profiles_lost);
LONGS_EQUAL(run->sensor_counters.frames, run->counts.profiles);
return std::move(run->cloud);
}  // namespace biteline
static evaluation::ReferenceSurface surface(const fs::path& session) {
  const auto mesh = cloud::read_mesh(session / "truth/reference.ply");
  SUCCEEDS(mesh);
  return evaluation::ReferenceSurface{*mesh};
}
static cloud::ClosedLine truth(const fs::path& session) {
  auto line = cloud::read_positions(session / "truth/groove.csv");
  SUCCEEDS(line);
  return *line;
}
/// Angles between the points' normals and those of the surface below them, sorted.
static std::vector<double> normal_errors_deg(const cloud::PointCloud& cloud,
                                             const evaluation::ReferenceSurface& surface) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < cloud.size(); i += 10) {
    const auto nearest = surface.nearest(cloud.points[i].cast<double>(), 1.0);
    if (!nearest) continue;
    const double cosine = std::min(1.0, nearest->normal.dot(cloud.normals[i].cast<double>()));
    errors.push_back(std::acos(cosine) * 180 / std::numbers::pi);
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}
static cloud::PointCloud shuffled(const cloud::PointCloud& cloud) {
  cloud::PointCloud out;
  out.points = cloud.points;
  std::mt19937_64 random{11};
  std::shuffle(out.points.begin(), out.points.end(), random);
  return out;
}
}
;

TEST(Sessions, MadeSportShoeIsMeasuredAndItsLineFound) {
  BITELINE_SHARED_DATA_OR_SKIP(session, "sessions/sport3");
  const cloud::PointCloud cloud = scan(session);
  const evaluation::ReferenceSurface reference = surface(session);
  const evaluation::CloudError cloud_error = evaluation::cloud_error(cloud, reference);
  CHECK_COMPARE(cloud_error.rms_mm, <=, 0.0105);
  CHECK_COMPARE(cloud_error.q999_mm, <=, 0.040);
  CHECK_COMPARE(std::max(cloud_error.max_mm, -cloud_error.min_mm), <=, 0.10);

  // Normals that came with the profiles are as good as those of a search through the finished cloud: both
  // smooth the fabric's texture, by some 3 degrees.  A tenth for the neighbourhoods, which are rows and not
  // discs.
  cloud::PointCloud searched = cloud;
  searched.normals = published::estimate_curvature(cloud.points, cloud.normals, {}).normal;
  const std::vector<double> live_deg = normal_errors_deg(cloud, reference);
  const std::vector<double> searched_deg = normal_errors_deg(searched, reference);
  for (const std::size_t tenth : {5, 9})
    CHECK_COMPARE(live_deg[live_deg.size() * tenth / 10], <=,
                  1.1 * searched_deg[searched_deg.size() * tenth / 10]);

  const bite_line::Extraction sut = bite_line::find_bite_line(cloud, {});
  CHECK_TEXT(sut.found, sut.reason().c_str());
  const evaluation::LineError error = evaluation::line_error(sut.line, truth(session));
  CHECK_COMPARE(error.mean_mm, <=, 0.05);
  CHECK_COMPARE(error.p95_mm, <=, 0.12);
  CHECK_COMPARE(error.max_mm, <=, 0.3);
  CHECK_COMPARE(error.complete, >=, 0.99);
  const auto normals_deg = evaluation::normal_error_deg(sut.line, reference, Vec3::UnitZ());
  CHECK(normals_deg.has_value());
  CHECK_COMPARE(*normals_deg, <=, 1.0);

  // A mesh without parts has one material: its stripe is carried, and says nothing.
  LONGS_EQUAL(cloud.size(), cloud.amplitude.size());
  LONGS_EQUAL(cloud.size(), cloud.width_px.size());
  CHECK_COMPARE(*std::ranges::min_element(cloud.amplitude), >, 0);
  cloud::PointCloud without = cloud;
  without.amplitude.clear();
  without.width_px.clear();
  DOUBLES_EQUAL(bite_line::find_bite_line(without, {}).confidence, sut.confidence, 0);

  // The same points without their scan order.
  const bite_line::Extraction scattered = bite_line::find_bite_line(shuffled(cloud), {});
  CHECK_TEXT(scattered.found, scattered.reason().c_str());
  CHECK_COMPARE(evaluation::line_error(scattered.line, sut.line).max_mm, <=, 0.05);
}

TEST(Sessions, RealShoeHasItsLine) {
  BITELINE_SHARED_DATA_OR_SKIP(session, "sessions/airjordan1");
  const bite_line::Extraction sut = bite_line::find_bite_line(scan(session), {});
  CHECK_TEXT(sut.found, sut.reason().c_str());
  const evaluation::LineError error = evaluation::line_error(sut.line, truth(session));
  CHECK_COMPARE(error.mean_mm, <=, 0.30);
  CHECK_COMPARE(error.complete, >=, 0.97);
}

TEST(Sessions, LedgeInAMidsoleIsNotTakenForTheLine) {
  BITELINE_SHARED_DATA_OR_SKIP(session, "sessions/ledge32");
  const bite_line::Extraction sut = bite_line::find_bite_line(scan(session), {});
  CHECK_TEXT(sut.verdict() != bite_line::Verdict::Refused, sut.reason().c_str());
  // The truth is of labels, good to 0.5 mm and 1 mm where the edge is round; the ledge lies 12 to 15 mm
  // lower.
  const test::LineOnShape on = test::line_on_shape(sut.line, truth(session));
  CHECK_COMPARE(on.mean_mm, <=, 0.5);
  CHECK_COMPARE(on.wrong_mm, <=, 5.0);
}

TEST(Sessions, UpperWithoutSoleIsRefused) {
  for (const char* name : {"sessions/bare4", "sessions/upper3"}) {
    BITELINE_SHARED_DATA_OR_SKIP(session, name);
    const bite_line::Extraction sut = bite_line::find_bite_line(scan(session), {});
    CHECK_TEXT(!sut.found, name);
    CHECK(!sut.reason().empty());
    CHECK(sut.line.points.empty());
  }
}

}  // namespace biteline
