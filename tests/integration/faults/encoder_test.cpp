// SPDX-License-Identifier: MIT
// An encoder as the pose, through the real sensor program: its count at each exposure, live, recorded, and
// replayed.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "common/session/session.hpp"
#include "common/wire/scan_file.hpp"
#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::test {
namespace {

namespace fs = std::filesystem;

/// What a profile says of its count, by its exposure in ns.
using Counts = std::map<std::int64_t, std::optional<std::int64_t>>;

void note(const profile::Profile& profile, Counts& counts) {
  counts[profile.header.exposure_mid.time_since_epoch().count()] = profile.header.encoder_ticks;
}

/// As they went over the wire.
Counts live_counts(const fs::path& session) {
  Counts counts;
  SUCCEEDS(
      wire::read_scan_file(session / "scan.btln",
                           [&](const wire::Message& message, std::span<const std::uint8_t>) -> Result<void> {
                             if (const auto* profile = std::get_if<profile::Profile>(&message.body))
                               note(*profile, counts);
                             return {};
                           }));
  return counts;
}

Counts replayed_counts(const fs::path& session) {
  Counts counts;
  auto sensor = intake::SensorProcess::start(
      *intake::find_sensor_program(), {"--source", "replay:" + session.string()}, std::chrono::seconds{30});
  SUCCEEDS(sensor);
  intake::SensorLinkConfig config;
  config.sensor = sensor->endpoint();
  auto link = intake::SensorLink::open(config);
  SUCCEEDS(link);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{60};
  for (bool over = false; !over && std::chrono::steady_clock::now() < deadline;) {
    const auto event = (*link)->next(std::chrono::milliseconds{50});
    SUCCEEDS(event);
    if (!*event) continue;
    if (const auto* profile = std::get_if<intake::ProfileEvent>(&**event)) note(profile->profile, counts);
    over = std::holds_alternative<wire::EndOfScan>(**event);
  }
  return counts;
}

}  // namespace

TEST_GROUP(EncoderPoseLong) {
  TemporaryFolder folder;
  fs::path session = folder.path() / "scan";

  void scan() const {
    const auto stand = FaultStand::set_up({.encoder_node = 5}, {"--record", session.string()});
    if (!stand) return;
    const auto refused = stand->start_scan();
    CHECK_TEXT(!refused, refused.value_or("").c_str());
    CHECK(stand->take_profiles(150));
    stand->command(wire::Command::StopScan);
    CHECK(stand->take_end());
  }
  /// The disk may still be at work.
  void wait_for_recording() const {
    for (int i = 0; i < 300; ++i) {
      const auto facts = session::read_recording_facts(session / "recording.yaml");
      if (facts && facts->complete) return;
      std::this_thread::sleep_for(std::chrono::milliseconds{50});
    }
    FAIL("the recording is not complete");
  }
};

TIMED_TEST(EncoderPoseLong, EachProfileHasItsCountLiveRecordedAndReplayed) {
  scan();
  if (!fs::exists(session)) return;
  wait_for_recording();
  const auto read = session::read_session(session);
  SUCCEEDS(read);
  for (const session::StampedPose& pose : read->poses) {
    CHECK(pose.encoder_ticks.has_value());
    DOUBLES_EQUAL(0.005 * static_cast<double>(*pose.encoder_ticks), pose.T_base_flange.translation().x(),
                  1e-9);
  }

  const Counts live = live_counts(session), replayed = replayed_counts(session);
  // Readings and counts are whole ticks: half a tick for each of four.
  constexpr double k_tolerance_ticks = 2;
  std::optional<std::pair<std::int64_t, std::int64_t>> first;
  std::size_t counted = 0, otherwise = 0;
  double worst_ticks = 0;
  for (const auto& [exposure_ns, ticks] : live) {
    const auto again = replayed.find(exposure_ns);
    if (again != replayed.end() && again->second != ticks) ++otherwise;
    if (!ticks) continue;
    ++counted;
    if (!first) first = {exposure_ns, *ticks};
    const double way_ticks =
        PictureCell::k_ticks_per_s * 1e-9 * static_cast<double>(exposure_ns - first->first);
    worst_ticks = std::max(worst_ticks, std::fabs(static_cast<double>(*ticks - first->second) - way_ticks));
  }
  std::printf(
      "%zu of %zu profiles have a count, %zu of %zu poses; within %.2f ticks; %zu replayed otherwise\n",
      counted, live.size(), read->poses.size(), read->poses.size(), worst_ticks, otherwise);
  CHECK(counted > 140 && counted + 20 > live.size());
  CHECK_COMPARE(worst_ticks, <=, k_tolerance_ticks);
  CHECK(replayed.size() > 140);
  CHECK_COMPARE(otherwise, <=, read->recorded->unrepeatable);
}

}  // namespace biteline::test
