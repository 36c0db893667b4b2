// SPDX-License-Identifier: MIT
// What `biteline replay` says of scans that show no shoe for another reason than the shoe: code, words, exit
// status.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "common/image/grey_image.hpp"
#include "host/intake/child_process.hpp"
#include "host/intake/scan_intake.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/made_session.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

wire::Bytes packet_of(wire::Body body, std::uint64_t sequence) {
  wire::Bytes packet;
  wire::encode({.scan_id = 7, .sequence = sequence, .body = std::move(body)}, packet);
  return packet;
}

}  // namespace

TEST_GROUP(CausesTool) {
  test::TemporaryFolder folder;
  test::MadeSession made;

  /// A scan of a floor as a host kept it.  `flags`: of each profile.  `end`: the scan came to its own.
  fs::path recorded(const std::function<std::uint32_t(int)>& flags, bool end) {
    const fs::path scan = folder.path() / "scan";
    fs::remove_all(scan);
    fs::create_directory(scan);
    intake::Hello hello;
    hello.scan_id = 7;
    hello.sensor.name = "left";
    hello.sensor.model = test::made_sensor(made);
    auto intake = intake::ScanIntake::begin(scan, hello, packet_of(hello.sensor, 0));
    SUCCEEDS(intake);
    constexpr int k_profiles = 60;
    for (int i = 0; i < k_profiles; ++i) {
      profile::Profile profile;
      profile.header.sequence = static_cast<std::uint64_t>(i);
      profile.header.exposure_mid = SensorClock::time_point{std::chrono::milliseconds{10 * i}};
      profile.header.T_base_flange = test::made_pose(i);
      profile.header.flags = flags(i);
      for (int column = 0; column < made.width_px; ++column) {
        profile::ProfilePoint point;
        point.point_cam = {0.2F * static_cast<float>(column), 0, 200};
        point.column = static_cast<std::uint16_t>(column);
        point.row_px = 100;
        profile.points.push_back(point);
      }
      const auto number = static_cast<std::uint64_t>(i);
      const wire::Bytes packet = packet_of(profile, number);
      SUCCEEDS(intake->take(intake::ProfileEvent{.sequence = number, .profile = std::move(profile)}, packet));
    }
    if (end) {
      wire::EndOfScan over;
      over.counters.profiles = over.counters.frames = k_profiles;
      SUCCEEDS(intake->take(over, packet_of(over, k_profiles)));
    }
    return scan / "scan.btln";
  }

  /// The made session with other pictures in it.
  fs::path session(const std::function<double(int u, int v)>& grey) {
    const fs::path root = folder.path() / "session";
    fs::remove_all(root);
    test::write_made_session(made, root);
    image::GreyImage picture{.width_px = made.width_px, .height_px = made.height_px, .pixels = {}};
    for (int v = 0; v < made.height_px; ++v)
      for (int u = 0; u < made.width_px; ++u)
        picture.pixels.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(grey(u, v), 0.0, 255.0))));
    for (const fs::directory_entry& file : fs::directory_iterator(root / "cam0/data"))
      SUCCEEDS(image::write_png(file.path(), picture));
    return root;
  }

  /// Exit status 3, that code, those words in the reason, and nothing of a shoe in it.
  nlohmann::json refused(const fs::path& input, const char* code, const char* words) {
    const fs::path out = folder.path() / "out";
    auto child = intake::ChildProcess::start(
        {.program = BITELINE_TOOL, .arguments = {"replay", input.string(), "--out", out.string()}});
    SUCCEEDS(child);
    const auto status = child->wait(120s);
    SUCCEEDS(status);
    LONGS_EQUAL(3, *status);
    STRCMP_CONTAINS(words, child->last_words().c_str());
    nlohmann::json report = test::read_json_file(out / "report.json");
    STRCMP_EQUAL("refused", report["status"].get<std::string>().c_str());
    STRCMP_EQUAL(code, report["reason_code"].get<std::string>().c_str());
    const std::string reason = report["reason"].get<std::string>();
    STRCMP_CONTAINS(words, reason.c_str());
    CHECK_TEXT(reason.find("shoe") == std::string::npos, reason.c_str());
    return report;
  }
};

TEST(CausesTool, ARecordedScanWithoutPoses) {
  const auto none = [](int) -> std::uint32_t { return profile::k_profile_pose_missing; };
  const nlohmann::json report =
      refused(recorded(none, true), "no_poses", "0 of 60 profiles can be used: no pose (60)");
  STRCMP_CONTAINS("arm's cable", report["next_step"].get<std::string>().c_str());
  // What the line's finder said of nothing is kept, and is not the reason.
  STRCMP_EQUAL("too_few_points", report["of_what_was_seen"]["reason_code"].get<std::string>().c_str());
}

TEST(CausesTool, ARecordedScanWithPosesFarFromTheExposures) {
  refused(recorded([](int i) -> std::uint32_t { return i < 50 ? profile::k_profile_pose_stale : 0; }, true),
          "poses_too_far", "10 of 60 profiles can be used: no pose near enough to the exposure (50)");
}

TEST(CausesTool, AScanThatWasCutIsNotJudged) {
  refused(recorded([](int) -> std::uint32_t { return 0; }, false), "scan_not_complete",
          "the scan is not complete: the scan has no end");
  // The poses go before the cut: scanning again alone would not help.
  refused(recorded([](int) -> std::uint32_t { return profile::k_profile_pose_missing; }, false), "no_poses",
          "no pose (60)");
}

TEST(CausesTool, PicturesWithoutStripeAndWithOneAlongTheColumns) {
  const nlohmann::json dark =
      refused(session([](int, int) { return 6.0; }), "no_stripe", "columns without: 100 %");
  STRCMP_CONTAINS("laser on", dark["next_step"].get<std::string>().c_str());
  refused(session([](int, int) { return 255.0; }), "no_stripe", "columns without: 100 %");
  const nlohmann::json upright = refused(session([](int u, int v) {
                                           const double off =
                                               u - (80 + 0.1 * (v - 48) + 6 * std::sin(v / 9.0));
                                           return 8 + 180 * std::exp(-off * off / 12);
                                         }),
                                         "stripe_along_columns", "does the stripe run along the columns?");
  STRCMP_CONTAINS("90 degrees", upright["next_step"].get<std::string>().c_str());
}

}  // namespace biteline
