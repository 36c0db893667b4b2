// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/calibration_check.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "host/apps/biteline-host/scan_row.hpp"

#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/calibration/drift/seen_ball.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

wire::Bytes packet_of(wire::Body body, std::uint64_t sequence) {
  wire::Bytes packet;
  wire::encode({.scan_id = 7, .sequence = sequence, .body = std::move(body)}, packet);
  return packet;
}

}  // namespace

TEST_GROUP(CalibrationCheck) {
  test::TemporaryFolder folder;
  Result<memory::Memory> memory = memory::Memory::open(folder.path() / memory::k_memory_file);
  int shoes{0};
  nlohmann::json report;

  fs::path next_folder() {
    const fs::path scan = folder.path() / ("scan-000" + std::to_string(shoes));
    fs::create_directory(scan);
    std::ofstream{scan / "report.json"} << R"({"status":"ok","length_mm":600})";
    return scan;
  }

  /// A ball's scan, as messages on disk and as the service has it.
  intake::ScanOutcome come_in(const fs::path& scan, const drift::BallScan& ball) {
    intake::Hello hello;
    hello.scan_id = 7;
    hello.sensor.name = "left";
    hello.sensor.model = drift::ball_head();
    auto intake = intake::ScanIntake::begin(scan, hello, packet_of(hello.sensor, 0));
    SUCCEEDS(intake);
    std::size_t point = 0;
    for (std::size_t p = 0; p < ball.poses.size(); ++p) {
      profile::Profile profile;
      profile.header.sequence = p;
      profile.header.exposure_mid =
          SensorClock::time_point{Nanoseconds{static_cast<std::int64_t>(1e9 * ball.poses[p].pose.time_s)}};
      profile.header.T_base_flange = ball.poses[p].pose.T_base_flange;
      const SE3 T_cam_base = (profile.header.T_base_flange * hello.sensor.model.T_flange_cam).inverse();
      for (std::uint16_t column = 0;
           point < ball.points_base.size() && ball.profile[point] == ball.poses[p].profile;
           ++point, ++column) {
        profile::ProfilePoint made;
        made.point_cam = (T_cam_base * ball.points_base[point].cast<double>()).cast<float>();
        made.column = column;
        profile.points.push_back(made);
      }
      const wire::Bytes packet = packet_of(profile, p);
      SUCCEEDS(intake->take(intake::ProfileEvent{.sequence = p, .profile = std::move(profile)}, packet));
    }
    return intake->finish();
  }

  Result<bool> judge(const fs::path& scan, const intake::ScanOutcome& outcome, OnDrift on_drift) {
    return check_calibration(scan, look_at_calibration(outcome), outcome.sensor.model, *memory, on_drift);
  }

  bool check(const drift::Vector& drifted = drift::Vector::Zero(), OnDrift on_drift = OnDrift::Warn) {
    const fs::path scan = next_folder();
    const auto outcome = come_in(
        scan, drift::scan_ball({.drifted = drifted, .seed = static_cast<std::uint64_t>(500 + shoes++)}));
    const Result<bool> sut = judge(scan, outcome, on_drift);
    SUCCEEDS(sut);
    report = test::read_json_file(scan / "report.json");
    return *sut;
  }
};

TEST(CalibrationCheck, EachScanSaysWhatItSawAndWhatItCannot) {
  SUCCEEDS(memory);
  CHECK_FALSE(check());
  LONGS_EQUAL(600, report["length_mm"].get<int>());
  const nlohmann::json& block = report["calibration_check"];
  STRCMP_EQUAL("learning", block["status"].get<std::string>().c_str());
  LONGS_EQUAL(drift::k_quantities, block["quantities"].size());
  CHECK(block["cannot_see"].is_array());
  CHECK(block["apart_mm"].get<double>() < 0.1);
}

TEST(CalibrationCheck, AScanWithoutPosesSaysSoAndNotThatNothingIsSeenTwice) {
  SUCCEEDS(memory);
  const fs::path scan = next_folder();
  intake::ScanOutcome outcome = come_in(scan, {});
  outcome.counts.profiles = outcome.sensor_counters.profiles = 815;
  outcome.counts.profiles_by_flag[0] = 815;  // pose_missing
  SUCCEEDS(judge(scan, outcome, OnDrift::Warn));
  const std::string why =
      test::read_json_file(scan / "report.json")["calibration_check"]["not_seen_because"].get<std::string>();
  STRCMP_CONTAINS("0 of 815 profiles can be used: no pose (815)", why.c_str());
  CHECK_TEXT(why.find("twice") == std::string::npos, why.c_str());
}

TEST(CalibrationCheck, ADriftIsToldKeptAndMarksTheScansRow) {
  SUCCEEDS(memory);
  for (int i = 0; i < 20; ++i) CHECK_FALSE(check());
  int after = 0;
  while (after < 5 && !check(drift::Vector::Unit(7), OnDrift::Stop)) ++after;
  CHECK(after < 5);
  const nlohmann::json& block = report["calibration_check"];
  STRCMP_EQUAL("drifted", block["status"].get<std::string>().c_str());
  STRCMP_EQUAL("stop", block["on_drift"].get<std::string>().c_str());
  STRCMP_EQUAL("calibration_drifted", block["reason_code"].get<std::string>().c_str());
  const auto row = row_of(folder.path() / ("scan-000" + std::to_string(shoes - 1)));
  CHECK(row.has_value());
  STRCMP_EQUAL("amber", row->verdict.c_str());
  STRCMP_EQUAL("calibration_drifted", row->reason_code.c_str());
  // Begun anew: what was a drift is the usual.
  SUCCEEDS(begin_calibration_check_anew(*memory, "anna"));
  CHECK_FALSE(check(drift::Vector::Unit(7)));
  LONGS_EQUAL(1, report["calibration_check"]["shoes"].get<int>());
}

TEST(CalibrationCheck, AnotherCalibrationBeginsAnew) {
  SUCCEEDS(memory);
  CHECK_FALSE(check());
  const fs::path scan = next_folder();
  intake::ScanOutcome outcome = come_in(scan, drift::scan_ball({.seed = 900}));
  outcome.sensor.model.laser_plane.distance_mm += 0.01;
  SUCCEEDS(judge(scan, outcome, OnDrift::Warn));
  report = test::read_json_file(scan / "report.json");
  LONGS_EQUAL(1, report["calibration_check"]["shoes"].get<int>());
}

TEST(CalibrationCheck, AScanThatSeesNothingTwiceSaysSoAndLeavesTheMemoryAlone) {
  SUCCEEDS(memory);
  const fs::path scan = next_folder();
  drift::BallScan once = drift::scan_ball({});
  once.points_base.resize(once.points_base.size() / 2);
  once.profile.resize(once.points_base.size());
  const auto sut = judge(scan, come_in(scan, once), OnDrift::Stop);
  SUCCEEDS(sut);
  CHECK_FALSE(*sut);
  report = test::read_json_file(scan / "report.json");
  STRCMP_EQUAL("not_seen", report["calibration_check"]["status"].get<std::string>().c_str());
  CHECK_FALSE(memory->setting("calibration_check")->has_value());
}

}  // namespace biteline::service
