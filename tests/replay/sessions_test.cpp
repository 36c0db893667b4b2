// SPDX-License-Identifier: MIT
// Recorded and made sessions through the sensor program and the host, against their truth.  Bounds in mm and degrees: what
// the product promises for such sessions, not what it happens to reach.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <random>

#include "host/groove/extract.hpp"
#include "host/ingest/session_run.hpp"
#include "host/measure/cloud_error.hpp"
#include "host/measure/line_error.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline {

namespace fs = std::filesystem;

TEST_GROUP(Sessions) {
  static cloud::PointCloud scan(const fs::path& session) {
    auto run = ingest::run_sensor_on_session(
        {.session = session, .sensor_file = {}, .program = fs::path{BITELINE_SENSOR}, .progress = {}, .on_profile = {}});
    SUCCEEDS(run);
    LONGS_EQUAL(0, run->counts.profiles_lost);
    LONGS_EQUAL(run->sensor_counters.frames, run->counts.profiles);
    return std::move(run->cloud);
  }
  static measure::ReferenceSurface surface(const fs::path& session) {
    const auto mesh = cloud::read_mesh(session / "truth/reference.ply");
    SUCCEEDS(mesh);
    return measure::ReferenceSurface{*mesh};
  }
  static line::ClosedLine truth(const fs::path& session) {
    auto line = line::read_positions(session / "truth/groove.csv");
    SUCCEEDS(line);
    return *line;
  }
  static cloud::PointCloud shuffled(const cloud::PointCloud& cloud) {
    cloud::PointCloud out;
    out.points = cloud.points;
    std::mt19937_64 random{11};
    std::shuffle(out.points.begin(), out.points.end(), random);
    return out;
  }
};

TEST(Sessions, MadeSportShoeIsMeasuredAndItsLineFound) {
  BITELINE_SHARED_DATA_OR_SKIP(session, "sessions/sport3");
  const cloud::PointCloud cloud = scan(session);
  const measure::ReferenceSurface reference = surface(session);
  const measure::CloudError cloud_error = measure::cloud_error(cloud, reference);
  CHECK_COMPARE(cloud_error.rms_mm, <=, 0.0105);
  CHECK_COMPARE(cloud_error.q999_mm, <=, 0.040);
  CHECK_COMPARE(std::max(cloud_error.max_mm, -cloud_error.min_mm), <=, 0.10);

  const groove::Extraction sut = groove::extract(cloud, {});
  CHECK_TEXT(sut.found, sut.reason.c_str());
  const measure::LineError error = measure::line_error(sut.line, truth(session));
  CHECK_COMPARE(error.mean_mm, <=, 0.05);
  CHECK_COMPARE(error.p95_mm, <=, 0.12);
  CHECK_COMPARE(error.max_mm, <=, 0.3);
  CHECK_COMPARE(error.complete, >=, 0.99);
  const auto normals_deg = measure::normal_error_deg(sut.line, reference, Vec3::UnitZ());
  CHECK(normals_deg.has_value());
  CHECK_COMPARE(*normals_deg, <=, 1.0);

  // The same points without their scan order.
  const groove::Extraction scattered = groove::extract(shuffled(cloud), {});
  CHECK_TEXT(scattered.found, scattered.reason.c_str());
  CHECK_COMPARE(measure::line_error(scattered.line, sut.line).max_mm, <=, 0.05);
}

TEST(Sessions, RealShoeHasItsLine) {
  BITELINE_SHARED_DATA_OR_SKIP(session, "sessions/airjordan1");
  const groove::Extraction sut = groove::extract(scan(session), {});
  CHECK_TEXT(sut.found, sut.reason.c_str());
  const measure::LineError error = measure::line_error(sut.line, truth(session));
  CHECK_COMPARE(error.mean_mm, <=, 0.30);
  CHECK_COMPARE(error.complete, >=, 0.97);
}

TEST(Sessions, UpperWithoutSoleIsRefused) {
  for (const char* name : {"sessions/bare4", "sessions/upper3"}) {
    BITELINE_SHARED_DATA_OR_SKIP(session, name);
    const groove::Extraction sut = groove::extract(scan(session), {});
    CHECK_TEXT(!sut.found, name);
    CHECK(!sut.reason.empty());
    CHECK(sut.line.points.empty());
  }
}

}  // namespace biteline
