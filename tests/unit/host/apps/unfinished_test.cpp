// SPDX-License-Identifier: MIT
// A scan that did not come to its own end: who ended it, and what would help.
#include <CppUTest/TestHarness.h>

#include "host/apps/biteline-host/attempt.hpp"
#include "host/apps/biteline-host/scan_pipeline.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {

TEST_GROUP(Unfinished) {
  test::TemporaryFolder folder;
  intake::ScanOutcome scan;

  void setup() override {
    scan.counts.profiles = scan.counts.profiles_used = 445;
    scan.failure = fail(Errc::InterlockOpen, "the interlock is open").value();
  }
  void flag(profile::ProfileFlag flag, std::uint64_t profiles) {
    scan.counts.profiles_used -= profiles;
    scan.counts.profiles_by_flag[static_cast<std::size_t>(__builtin_ctz(flag))] = profiles;
  }
  nlohmann::json refused(const char* code) {
    intake::LiveLine line{bite_line::Config{}};
    const auto step = find_line(folder.path(), scan, line, {}, "");
    SUCCEEDS(step);
    CHECK(step->status == ExitStatus::Refused);
    CHECK(!step->line);
    nlohmann::json report = test::read_json_file(folder.path() / "report.json");
    STRCMP_EQUAL(code, report["reason_code"].get<std::string>().c_str());
    CHECK(report["reason"].get<std::string>().find("shoe") == std::string::npos);
    // Whatever was scanned can be looked at.
    CHECK(std::filesystem::exists(folder.path() / "view_data.js"));
    return report;
  }
};

TEST(Unfinished, WhatEndedItIsToldWithTheProfilesThatCame) {
  const nlohmann::json report = refused("scan_not_complete");
  STRCMP_CONTAINS("after 445 profiles: the interlock is open", report["reason"].get<std::string>().c_str());
}

TEST(Unfinished, WhatKeptTheProfilesOutGoesBeforeTheCut) {
  flag(profile::k_profile_pose_missing, 445);
  const std::string reason = refused("no_poses")["reason"].get<std::string>();
  STRCMP_CONTAINS("0 of 445 profiles can be used: no pose (445)", reason.c_str());
  STRCMP_CONTAINS("not complete either: the interlock is open", reason.c_str());
}

TEST(Unfinished, ASensorWithoutTimeIsToldAsThat) {
  scan.sensor_counters.profiles_dropped = 200;
  STRCMP_CONTAINS("had no time", refused("no_time")["reason"].get<std::string>().c_str());
}

TEST(Unfinished, AWayThatHasNotMetTheStripeYetAndTheFirstFewProfilesSayNothing) {
  flag(profile::k_profile_stripe_lost, 445);
  static_cast<void>(refused("scan_not_complete"));
  scan.counts = {};
  scan.counts.profiles = scan.counts.profiles_used = 20;
  flag(profile::k_profile_pose_missing, 20);
  static_cast<void>(refused("scan_not_complete"));
}

TEST(Unfinished, APersonsStopGoesBeforeEverything) {
  flag(profile::k_profile_pose_missing, 445);
  scan.stopped_by = "ada";
  scan.failure = stopped_on_its_way("ada");
  STRCMP_CONTAINS("stopped by ada after 445 profiles",
                  refused("stopped_by_a_person")["reason"].get<std::string>().c_str());
}

}  // namespace biteline::service
