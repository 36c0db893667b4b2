// SPDX-License-Identifier: MIT
// The next upper of a scanned sample, from recorded stripe pictures to its line.  Bounds: the product's own
// promises.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "host/bite_line/evaluation/line_error.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/intake/session_run.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline {
namespace {

namespace fs = std::filesystem;

cloud::PointCloud scan(const fs::path& session) {
  auto run = intake::run_sensor_on_session({.session = session,
                                            .sensor_file = {},
                                            .sensor_options = {},
                                            .program = fs::path{BITELINE_SENSOR},
                                            .progress = {},
                                            .on_profile = {}});
  SUCCEEDS(run);
  return std::move(run->cloud);
}

cloud::PointCloud moved(cloud::PointCloud cloud, const Eigen::Affine3d& motion) {
  for (Eigen::Vector3f& p : cloud.points) p = (motion * p.cast<double>()).cast<float>();
  return cloud;
}

/// Scanned and extracted once for all tests of this file.
const transfer::SampleFiles& sample_of(const fs::path& session) {
  static const transfer::SampleFiles sample = [&] {
    cloud::PointCloud cloud = scan(session);
    const bite_line::Extraction extraction = bite_line::find_bite_line(cloud, {});
    CHECK_TEXT(extraction.found, extraction.reason().c_str());
    return transfer::SampleFiles{.cloud = std::move(cloud), .line = extraction.line};
  }();
  return sample;
}

const cloud::PointCloud& upper_of(const fs::path& session) {
  static const cloud::PointCloud cloud = scan(session);
  return cloud;
}

cloud::ClosedLine truth_of(const fs::path& session) {
  auto truth = cloud::read_positions(session / "truth/groove.csv");
  SUCCEEDS(truth);
  return *truth;
}

}  // namespace

TEST_GROUP(TransferOfSessions){};

TEST(TransferOfSessions, TheUpperOfTheSportShoeGetsItsLine) {
  BITELINE_SHARED_DATA_OR_SKIP(sample, "sessions/sport3");
  BITELINE_SHARED_DATA_OR_SKIP(upper, "sessions/upper3");
  const transfer::Transfer sut = transfer::transfer_line(sample_of(sample), upper_of(upper), {});
  CHECK_TEXT(sut.found, sut.reason().c_str());
  const evaluation::LineError error = evaluation::line_error(sut.carried.line, truth_of(upper));
  CHECK_COMPARE(error.mean_mm, <=, 0.15);
  CHECK_COMPARE(error.p95_mm, <=, 0.35);
  CHECK_COMPARE(error.p95_mm, <=, sut.bound_mm);
  const auto mesh = cloud::read_mesh(upper / "truth/reference.ply");
  SUCCEEDS(mesh);
  const auto normals =
      evaluation::normal_error_deg(sut.carried.line, evaluation::ReferenceSurface{*mesh}, Vec3::UnitZ());
  CHECK(normals.has_value());
  CHECK_COMPARE(*normals, <=, 1.5);
}

TEST(TransferOfSessions, EveryOneOfTwoHundredStartPosesEndsRight) {
  BITELINE_SHARED_DATA_OR_SKIP(sample_session, "sessions/sport3");
  BITELINE_SHARED_DATA_OR_SKIP(upper_session, "sessions/upper3");
  const transfer::SampleFiles& files = sample_of(sample_session);
  const transfer::Sample sample = *transfer::prepare_sample(files.cloud, files.line);
  const cloud::PointCloud& upper = upper_of(upper_session);
  const transfer::Alignment home = transfer::align(sample, *transfer::prepare_upper(upper), {});
  std::mt19937_64 random{41};
  std::uniform_real_distribution<double> unit{-1, 1};
  for (int i = 0; i < 200; ++i) {
    const double tilt_rad = 10 * std::numbers::pi / 180 * unit(random),
                 yaw_rad = std::numbers::pi * unit(random);
    const SE3 T =
        geometry::make_se3(Eigen::AngleAxisd{tilt_rad, Vec3{unit(random), unit(random), 0}.normalized()} *
                               Eigen::Quaterniond{Eigen::AngleAxisd{yaw_rad, Vec3::UnitZ()}},
                           {400 * unit(random), 400 * unit(random), 100 * unit(random)});
    const transfer::Alignment sut =
        transfer::align(sample, *transfer::prepare_upper(moved(upper, Eigen::Affine3d{T.matrix()})), {});
    CHECK(sut.accepted());
    const SE3 difference = home.T_upper_sample.inverse() * T.inverse() * sut.T_upper_sample;
    // Other voxels, other surfels: what is left is their grain.
    const Vec3 heel = files.line.points.front().position;
    CHECK_COMPARE((difference * heel - heel).norm(), <=, 0.1);
  }
}

TEST(TransferOfSessions, WhatIsNotTheNextUpperIsRefusedEachWithItsOwnReason) {
  BITELINE_SHARED_DATA_OR_SKIP(sample, "sessions/sport3");
  BITELINE_SHARED_DATA_OR_SKIP(upper, "sessions/upper3");
  BITELINE_SHARED_DATA_OR_SKIP(bare, "sessions/bare4");
  Eigen::Affine3d mirror = Eigen::Affine3d::Identity(), larger = Eigen::Affine3d::Identity();
  mirror.linear()(1, 1) = -1;
  larger.linear() *= 1.05;
  struct Row {
    cloud::PointCloud cloud;
    transfer::Refused code;
  };
  for (const Row& row : {Row{scan(bare), transfer::Refused::OtherModel},
                         Row{moved(upper_of(upper), mirror), transfer::Refused::OtherFoot},
                         Row{moved(upper_of(upper), larger), transfer::Refused::OtherSize}}) {
    const transfer::Transfer sut = transfer::transfer_line(sample_of(sample), row.cloud, {});
    CHECK_FALSE(sut.found);
    CHECK_TEXT(sut.refusal && sut.refusal->code == row.code, sut.reason().c_str());
  }
}

}  // namespace biteline
