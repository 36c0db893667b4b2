// SPDX-License-Identifier: MIT
// The table of causes: what kept a shoe from being seen is named, and not the shoe.
#include "host/intake/scan_cause.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include "firmware/pipeline/profile_pipeline.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/made_head.hpp"

namespace biteline::intake {
namespace {

constexpr int k_width_px = 320, k_height_px = 160;
constexpr int k_profiles = 100;

/// Grey at a place, without noise.
using Scene = std::function<double(int u, int v, int frame)>;

double gauss(double off_px) {
  constexpr double k_sigma_px = 2.1;
  return std::abs(off_px) > 12 ? 0 : std::exp(-off_px * off_px / (2 * k_sigma_px * k_sigma_px));
}

/// Across the columns, over a shoe's side.
double along_the_rows(int u, int v, int frame) {
  return 5 + 180 * gauss(v - (80 + 25 * std::sin((u + 3 * frame) / 40.0)));
}
/// Laser and camera side by side instead of one above the other; `lean`: columns for each row.
Scene along_the_columns(double lean) {
  return [lean](int u, int v, int frame) {
    return 5 + 180 * gauss(u - (150 + lean * (v - 80) + 12 * std::sin((v + 3 * frame) / 20.0)));
  };
}
double dark(int, int, int) {
  return 5;
}
double overexposed(int, int, int) {
  return 300;
}
/// Lamps of the hall, no laser.
double flat_light(int u, int v, int) {
  return 90 + 0.1 * u + 0.05 * v;
}
/// Lit in a quarter of the frames: the rest of the way the stripe lies beside the region.
double beside_the_region(int u, int v, int frame) {
  return frame % 4 == 0 ? along_the_rows(u, v, frame) : dark(u, v, frame);
}

struct Scan {
  IngestCounts counts;
  wire::Counters sensor;
  wire::Devices devices;
  cloud::PointCloud cloud;
};

/// Through the sensor's own pipeline, then as profiles come in.  `flags`: of each profile.
Scan scan_of(const Scene& scene, const std::function<std::uint32_t(int frame)>& flags = {}) {
  std::mt19937_64 random{5};
  std::normal_distribution<double> noise{0, 1.2};
  const geometry::SensorModel head = test::made_head(k_width_px, k_height_px);
  auto pipeline = pipeline::ProfilePipeline::create({}, head);
  CHECK(pipeline.has_value());
  const auto out = std::make_unique<profile::ProfileBuffer>();
  CloudBuilder builder{head};
  Scan scan;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(k_width_px * k_height_px));
  for (int frame = 0; frame < k_profiles; ++frame) {
    for (int v = 0; v < k_height_px; ++v) {
      for (int u = 0; u < k_width_px; ++u) {
        const double grey = std::clamp(scene(u, v, frame) + noise(random), 0.0, 255.0);
        pixels[static_cast<std::size_t>(v * k_width_px + u)] = static_cast<std::uint8_t>(std::lround(grey));
      }
    }
    const SensorClock::time_point at{std::chrono::milliseconds{10 * frame}};
    CHECK(pipeline->rt_process({.pixels = pixels,
                                .width_px = k_width_px,
                                .height_px = k_height_px,
                                .stride_bytes = k_width_px,
                                .sequence = static_cast<std::uint64_t>(frame),
                                .exposure_mid = at,
                                .flags = 0},
                               *out));
    profile::Profile profile{.header = out->header, .points = {out->view().begin(), out->view().end()}};
    profile.header.flags &= ~static_cast<std::uint32_t>(profile::k_profile_pose_missing);
    if (flags) profile.header.flags |= flags(frame);
    if ((profile.header.flags & profile::k_profile_pose_stale) != 0)
      profile.header.pose_age = std::chrono::milliseconds{340};
    profile.header.T_base_flange.translation() = Vec3(0.5 * frame, 0, 400);
    builder.add(profile);
  }
  scan.counts = builder.counts();
  scan.sensor.profiles = scan.sensor.frames = k_profiles;
  scan.sensor.poses = 500;
  scan.cloud = builder.take();
  return scan;
}

std::function<std::uint32_t(int)> in_share(double share, std::uint32_t flag) {
  return [share, flag](int frame) { return frame % 20 < 20 * share ? flag : 0U; };
}

/// What a person is told of a scan in which no line was found.
report::ToldRefusal told_of(const Scan& scan) {
  bite_line::Extraction extraction = bite_line::find_bite_line(scan.cloud, {}, nullptr);
  CHECK_FALSE(extraction.found);
  name_scan_cause(extraction, scan.counts, scan.sensor, &scan.devices);
  return *extraction.told();
}

void names(const Scan& scan, const char* code, std::initializer_list<const char*> words, const char* step) {
  const report::ToldRefusal told = told_of(scan);
  STRCMP_EQUAL(code, told.reason_code.c_str());
  for (const char* word : words) STRCMP_CONTAINS(word, told.reason.c_str());
  STRCMP_CONTAINS(step, told.next_step.c_str());
  // Nothing of what this cause is not about.
  for (const char* word : {"shoe", "sole", "more slowly"}) {
    CHECK_TEXT(told.reason.find(word) == std::string::npos, told.reason.c_str());
    CHECK_TEXT(told.next_step.find(word) == std::string::npos, told.next_step.c_str());
  }
}

}  // namespace

TEST_GROUP(ScanCause){};

TEST(ScanCause, NoPosesAtAll) {
  Scan scan = scan_of(along_the_rows, in_share(1, profile::k_profile_pose_missing));
  scan.sensor.poses = 0;
  names(scan, "no_poses", {"0 of 100 profiles can be used", "no pose (100)"}, "arm's cable");
}

TEST(ScanCause, PosesThatStoppedOrComeTooLate) {
  names(scan_of(along_the_rows, in_share(1, profile::k_profile_pose_stale)), "poses_too_far",
        {"0 of 100 profiles can be used", "no pose near enough to the exposure (100)", "500 poses came",
         "340 ms"},
        "pose_clock_offset");
}

TEST(ScanCause, MostOrManyProfilesWithoutPose) {
  names(scan_of(along_the_rows, in_share(0.8, profile::k_profile_pose_missing)), "no_poses",
        {"20 of 100 profiles can be used", "no pose (80)"}, "arm's cable");
  names(scan_of(along_the_rows, in_share(0.15, profile::k_profile_pose_stale)), "poses_too_far",
        {"85 of 100 profiles"}, "cable");
}

TEST(ScanCause, TheMostFrequentOfSeveralIsTheCauseAndAllAreCounted) {
  names(scan_of(along_the_rows,
                [](int frame) {
                  return frame % 10 < 2 ? profile::k_profile_frame_damaged
                                        : static_cast<std::uint32_t>(profile::k_profile_pose_missing);
                }),
        "no_poses", {"0 of 100", "no pose (80)", "damaged (20)"}, "cable");
}

TEST(ScanCause, ClockTriggerAndDamagedPictures) {
  names(scan_of(along_the_rows, in_share(1, profile::k_profile_clock_unsure)), "clock_unsure",
        {"clock is not sure (100)"}, "clock");
  names(scan_of(along_the_rows, in_share(1, profile::k_profile_trigger_mismatch)), "trigger_mismatch",
        {"trigger edge of its own (100)"}, "trigger and strobe");
  names(scan_of(along_the_rows, in_share(0.5, profile::k_profile_frame_damaged)), "frames_damaged",
        {"50 of 100", "damaged (50)"}, "camera's cable");
}

TEST(ScanCause, NoStripe) {
  for (const Scene& scene : {Scene{dark}, Scene{overexposed}, Scene{flat_light}})
    names(scan_of(scene), "no_stripe", {"only 0 of 100 profiles show a stripe", "columns without: 100 %"},
          "laser on");
  names(scan_of(beside_the_region), "no_stripe", {"only 25 of 100 profiles"}, "inside the region");
}

TEST(ScanCause, PosesGoBeforeTheStripe) {
  // Neither: who mends the light first would still have nothing.
  names(scan_of(dark, in_share(1, profile::k_profile_pose_missing)), "no_poses", {"0 of 100"}, "arm's cable");
}

TEST(ScanCause, StripeAlongTheColumns) {
  for (const double lean : {0.0, 0.15, -0.2})
    names(scan_of(along_the_columns(lean)), "stripe_along_columns",
          {"columns without a stripe: ", "does the stripe run along the columns?"}, "by 90 degrees");
}

TEST(ScanCause, TurnedByNinetyDegreesAStripeAlongTheColumnsIsNoCauseAnyMore) {
  const Scene wrong = along_the_columns(0.1);
  const Scan right = scan_of([&](int u, int v, int frame) { return wrong(v + 70, u - 80, frame); });
  CHECK_FALSE(scan_cause(right.counts, right.sensor).has_value());
}

TEST(ScanCause, SensorOrHostHadNoTime) {
  Scan scan = scan_of(along_the_rows);
  scan.sensor.profiles_dropped = 60;
  names(scan, "no_time", {"sensor or host had no time", "of 160 pictures 60 were lost"},
        "end what else runs");
  scan = scan_of(along_the_rows);
  scan.sensor.frames_lost = 40;
  scan.devices.camera_underruns = 38;
  names(scan, "no_time", {"of 140 pictures 40 were lost"}, "end what else runs");
  scan = scan_of(along_the_rows, in_share(0.5, profile::k_profile_overrun));
  scan.sensor.frames_lost = 40;
  scan.sensor.overruns = 50;
  names(scan, "no_time", {"50 came late"}, "end what else runs");
  scan = scan_of(along_the_rows);
  scan.counts.profiles_lost = 30;  // between sensor and host
  names(scan, "no_time", {"of 130 pictures 30 were lost"}, "end what else runs");
}

TEST(ScanCause, PicturesThatDidNotComeFromTheCamera) {
  Scan scan = scan_of(along_the_rows);
  scan.sensor.frames_lost = 100;
  names(scan, "frames_lost", {"of 200 pictures 100 were lost on the way from the camera"}, "camera's cable");
}

TEST(ScanCause, ASoundScanWithoutAShoeIsStillToldAsSuch) {
  Scan scan = scan_of(along_the_rows);
  scan.sensor.frames_lost = 5;
  const report::ToldRefusal told = told_of(scan);
  STRCMP_CONTAINS("not a shoe", told.reason.c_str());
  // Nor do the few profiles that every scan has without pose or stripe change that.
  const Scan usual = scan_of(along_the_rows, in_share(0.05, profile::k_profile_pose_stale));
  STRCMP_CONTAINS("not a shoe", told_of(usual).reason.c_str());
}

TEST(ScanCause, WhatWasFoundStaysFoundAndACarriedLineHasTheSameCause) {
  const Scan scan = scan_of(along_the_rows, in_share(0.5, profile::k_profile_pose_missing));
  bite_line::Extraction found;
  found.found = true;
  name_scan_cause(found, scan.counts, scan.sensor);
  CHECK_FALSE(found.told().has_value());
  transfer::Transfer carried;
  carried.refusal = transfer::Refusal{.code = transfer::Refused::UpperWithoutShoe, .reason = "not a shoe"};
  STRCMP_EQUAL("not a shoe", carried.reason().c_str());
  name_scan_cause(carried, scan.counts, scan.sensor);
  STRCMP_EQUAL("no_poses", carried.told()->reason_code.c_str());
  STRCMP_CONTAINS("50 of 100", carried.reason().c_str());
}

TEST(ScanCause, AScanOfNothingHasNoCause) {
  CHECK_FALSE(scan_cause({}, {}).has_value());
}

}  // namespace biteline::intake
