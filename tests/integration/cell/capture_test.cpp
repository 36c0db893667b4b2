// SPDX-License-Identifier: MIT
/// \file Exposures and rows that change while the sensor program scans in the simulated cell: its points must
/// stay on the made shoe, whatever the camera was told.
#include <CppUTest/TestHarness.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <span>
#include <thread>
#include <utility>

#include "common/config/sensor_yaml.hpp"
#include "common/profile/profile.hpp"
#include "common/settings/settings.hpp"
#include "hal/sim/bus/board_file.hpp"
#include "hal/sim/live/live_cell.hpp"
#include "hal/sim/shoe/surface_distance.hpp"
#include "host/intake/sensor_link.hpp"
#include "host/intake/sensor_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::sim {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// What the cell is like, and how the sensor program is told to look at it.
struct Trial {
  double ambient_grey{0};
  double exposure_ratio{1};  ///< of the head's own exposure in sensor.yaml
  std::vector<std::string> options;
};

struct Outcome {
  std::vector<profile::Profile> profiles;
  wire::EndOfScan end;
  bool ended{false};
};

LiveSettings settings_of(const Trial& trial) {
  LiveSettings settings;
  settings.scene = {.shoe = draw_shoe(ShoeClass::Deep, 4),
                    .scan_speed_mm_s = 150,
                    .rate_hz = 25,
                    .ambient_grey = trial.ambient_grey,
                    .fineness = {.column_mm = 1.0, .coarse_row_mm = 0.5}};
  settings.wires = "biteline-capture-test-" + std::to_string(getpid());
  settings.scan_after_laser = milliseconds{200};
  return settings;
}

/// The standard fixes the camera's port, so one camera at a time lives on an address.
std::unique_ptr<LiveCell> open_cell(const LiveSettings& settings) {
  const auto patience_ends = hal::monotonic_now() + seconds{15};
  do {
    if (auto cell = LiveCell::open(settings)) {
      test::note_ran();
      return std::move(*cell);
    }
    std::this_thread::sleep_for(milliseconds{100});  // until another test gives the port back
  } while (hal::monotonic_now() < patience_ends);
  test::note_skipped("GigE Vision port 3956 on 127.0.0.1 is not free");
  return nullptr;
}

}  // namespace

TEST_GROUP(Capture) {
  test::TemporaryFolder folder;
  std::unique_ptr<LiveCell> cell;

  std::vector<std::string> arguments(const Trial& trial, const char* rights) const {
    geometry::SensorModel head = cell->scene().head.model;
    head.exposure = Nanoseconds{
        static_cast<std::int64_t>(static_cast<double>(head.exposure->count()) * trial.exposure_ratio)};
    const auto file = folder.path() / "sensor.yaml";
    std::ofstream{file} << config::sensor_yaml_text(head, "made head");
    const auto board = folder.path() / "board.yaml";
    std::ofstream{board} << board_yaml_text({.wires = cell->settings().wires});
    std::vector<std::string> out{"--source", "board:" + board.string(), "--sensor", file.string(), "--rt",
                                 rights};
    out.insert(out.end(), trial.options.begin(), trial.options.end());
    return out;
  }

  static constexpr int k_attempts = 8;
  /// The whole way round, which is five seconds: where the laser went off the arm's line falls too, and may
  /// be first.
  static bool complete(const Outcome& outcome) {
    return outcome.ended && outcome.end.errc == 0 && outcome.profiles.size() > 50;
  }

  /// One scan by the sensor program, from the host's word to the arm's end.  A scan that a busy machine ended
  /// (the laser's guard wants frames) is tried again.
  Outcome scan(const Trial& trial) {
    Outcome outcome;
    for (int attempt = 0; attempt < k_attempts && !complete(outcome); ++attempt) outcome = scan_once(trial);
    return outcome;
  }
  Outcome scan_once(const Trial& trial) {
    Outcome outcome;
    cell.reset();
    cell = open_cell(settings_of(trial));
    if (!cell) return outcome;
    // With real-time rights where there are any: then no program beside it ends its scan.
    auto sensor = intake::SensorProcess::start(*intake::find_sensor_program(), arguments(trial, "required"),
                                               seconds{30});
    if (!sensor) {
      sensor = intake::SensorProcess::start(*intake::find_sensor_program(), arguments(trial, "ignore"),
                                            seconds{30});
    }
    SUCCEEDS(sensor);
    intake::SensorLinkConfig config;
    config.sensor = sensor->endpoint();
    auto link = intake::SensorLink::open(config);
    SUCCEEDS(link);
    bool asked = false;
    const auto patience_ends = hal::monotonic_now() + seconds{20};
    while (!outcome.ended && hal::monotonic_now() < patience_ends) {
      auto event = (*link)->next(milliseconds{20});
      SUCCEEDS(event);
      if (!*event) continue;
      // Each scan begins with a hello as well: the first one only is this host's own.
      if (std::holds_alternative<intake::Hello>(**event) && !std::exchange(asked, true))
        (*link)->command({.id = 1, .command = wire::Command::StartScan});
      if (const auto* reply = std::get_if<wire::ControlReply>(&**event))
        CHECK_EQUAL_TEXT(0, reply->errc, reply->where.c_str());
      if (auto* profile = std::get_if<intake::ProfileEvent>(&**event))
        outcome.profiles.push_back(std::move(profile->profile));
      if (auto* end = std::get_if<wire::EndOfScan>(&**event)) {
        outcome.end = std::move(*end);
        outcome.ended = true;
      }
    }
    return outcome;
  }

  /// RMS distance of the surface's points from the made shoe's wall; the rest of the shoe has no closed form.
  double rms_mm(const Outcome& outcome, std::size_t* points = nullptr) const {
    const SurfaceDistance distance{cell->scene().shoe};
    double sum = 0;
    std::size_t count = 0;
    for (const profile::Profile& profile : outcome.profiles) {
      if (profile.header.flags & profile::k_profile_not_usable) continue;
      const SE3 T_shoe_cam = cell->scene().T_base_shoe.inverse(Eigen::Isometry) *
                             profile.header.T_base_flange * cell->scene().head.model.T_flange_cam;
      for (std::size_t i = 0; i < profile.points.size(); i += 7) {
        const profile::ProfilePoint& point = profile.points[i];
        if (point.flags & (profile::k_point_not_surface | profile::k_point_discontinuous)) continue;
        const Vec3 at = T_shoe_cam * point.point_cam.cast<double>();
        if (at.z() < 1 || at.z() > cell->scene().settings.shoe.upper.top_z_mm - 2) continue;
        sum += std::min(0.25, std::pow(distance.signed_distance_mm(at), 2));
        ++count;
      }
    }
    if (points != nullptr) *points = count;
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
  }

  /// Of all points of these profiles: one profile alone may lie at the end of the shoe, in shadow.
  static double median_amplitude(std::span<const profile::Profile> profiles) {
    std::vector<float> amplitudes;
    for (const profile::Profile& profile : profiles) {
      for (const profile::ProfilePoint& point : profile.points) amplitudes.push_back(point.amplitude);
    }
    if (amplitudes.empty()) return 0;
    std::nth_element(amplitudes.begin(),
                     amplitudes.begin() + static_cast<std::ptrdiff_t>(amplitudes.size() / 2),
                     amplitudes.end());
    return amplitudes[amplitudes.size() / 2];
  }

  /// As for a recorded session: poses 0.010 mm, peaks 0.01, facets; a stamp wrong by 1 ms would add 0.15 mm
  /// at the toe.
  static constexpr double k_on_surface_mm = 0.04;
};

TIMED_TEST(Capture, ExposureThatIsSixTimesTooShortIsCorrectedOnTheWay) {
  const Outcome outcome = scan({.exposure_ratio = 1.0 / 6, .options = {"--auto-exposure"}});
  if (!cell) return;
  CHECK(outcome.ended);
  CHECK_EQUAL_TEXT(0, outcome.end.errc, outcome.end.where.c_str());
  CHECK(outcome.profiles.size() > 60);
  const auto lit = std::find_if(outcome.profiles.begin(), outcome.profiles.end(),
                                [](const auto& p) { return p.points.size() > 300; });
  CHECK(lit != outcome.profiles.end());
  const std::span<const profile::Profile> profiles{outcome.profiles};
  CHECK_COMPARE(median_amplitude({&*lit, 1}), <, 70);
  CHECK_COMPARE(median_amplitude(profiles.last(profiles.size() / 4)), >, 90);
  CHECK(outcome.end.devices.capture.has_value());
  CHECK(outcome.end.devices.capture->exposure_changes >= 2);
  // Bright stretches before the end cut it by 0.7 again.  More than one smallest step of 1.15 is left.
  CHECK_COMPARE(outcome.end.devices.capture->exposure.count(), >,
                cell->scene().head.model.exposure->count() / 5);
  // Stamps are the middle of exposures that were changing.
  CHECK_COMPARE(rms_mm(outcome), <, k_on_surface_mm);
}

TIMED_TEST(Capture, BracketsAreMergedAndEachPointTellsItsExposure) {
  const Outcome outcome = scan({.exposure_ratio = 0.25, .options = {"--second-exposure-us", "1200"}});
  if (!cell) return;
  CHECK(outcome.ended);
  CHECK_EQUAL_TEXT(0, outcome.end.errc, outcome.end.where.c_str());
  std::size_t first = 0, second = 0;
  for (const profile::Profile& profile : outcome.profiles) {
    for (const profile::ProfilePoint& point : profile.points) {
      (point.flags & profile::k_point_second_exposure ? second : first) += 1;
    }
  }
  // Two frames, one profile.
  CHECK(outcome.profiles.size() > 30);
  CHECK_COMPARE(3 * outcome.profiles.size(), <, 2 * outcome.end.counters.frames);
  CHECK(first > 1000);
  CHECK(second > 1000);
  std::size_t points = 0;
  CHECK_COMPARE(rms_mm(outcome, &points), <, k_on_surface_mm);
  CHECK(points > 1000);
}

TIMED_TEST(Capture, RoomLightIsTakenOffByFramesWithoutLaser) {
  const Outcome outcome = scan({.ambient_grey = 60, .options = {"--laser-off-frames"}});
  if (!cell) return;
  CHECK(outcome.ended);
  CHECK_EQUAL_TEXT(0, outcome.end.errc, outcome.end.where.c_str());
  // Half of the frames are dark and make no profile.
  CHECK(outcome.profiles.size() > 30);
  CHECK_COMPARE(3 * outcome.profiles.size(), <, 2 * outcome.end.counters.frames);
  std::size_t lit_profiles = 0, points = 0;
  for (const profile::Profile& profile : outcome.profiles)
    lit_profiles += profile.points.size() > 300 ? 1U : 0U;
  CHECK(lit_profiles > 30);
  CHECK_COMPARE(rms_mm(outcome, &points), <, k_on_surface_mm);
  CHECK(points > 1000);
}

TIMED_TEST(Capture, RowsFollowTheStripeAndPointsStayWhereTheyAre) {
  const Outcome outcome = scan({.options = {"--follow-stripe"}});
  if (!cell) return;
  CHECK(outcome.ended);
  CHECK_EQUAL_TEXT(0, outcome.end.errc, outcome.end.where.c_str());
  CHECK(outcome.end.devices.capture.has_value());
  const wire::CaptureState& capture = *outcome.end.devices.capture;
  CHECK(capture.row_changes >= 1);
  CHECK(capture.rate_max_hz > 0);
  std::size_t points = 0;
  CHECK_COMPARE(rms_mm(outcome, &points), <, k_on_surface_mm);
  CHECK(points > 2000);
  // Fewer rows than at first, and no frame lost over it but by a busy machine.
  CHECK_COMPARE(capture.rows_px, <, cell->scene().head.model.region.height_px);
  CHECK_COMPARE(outcome.end.counters.frames_lost, <, 10U);
}

TIMED_TEST(Capture, ASetIsTakenByTheCameraAndKeptWithTheRecording) {
  const auto file =
      folder.write("set.yaml", "camera:\n  exposure_us: 300\n  gain: 3.5\npeaks: {choice: strongest}\n...\n");
  const std::string recording = folder.path() / "live";
  const Outcome outcome = scan({.options = {"--settings", file, "--record", recording}});
  if (!cell) return;
  CHECK_EQUAL_TEXT(0, outcome.end.errc, outcome.end.where.c_str());
  CHECK_COMPARE(rms_mm(outcome), <, k_on_surface_mm);
  const auto used = settings::read_settings(recording + "/settings.yaml");
  SUCCEEDS(used);
  DOUBLES_EQUAL(300, *used->number(settings::Key::ExposureUs), 0.5);
  DOUBLES_EQUAL(3.5, *used->number(settings::Key::Gain), 0.005);
  DOUBLES_EQUAL(25, *used->number(settings::Key::RateHz), 0);
  STRCMP_EQUAL("strongest", used->word(settings::Key::PeakChoice)->c_str());
}

TEST(Capture, ASetThatTheCameraDoesNotTakeIsRefusedByLineKeyAndRange) {
  cell = open_cell(settings_of({}));
  if (!cell) return;
  const auto file = folder.write("set.yaml", "camera:\n  exposure_us: 300\n  gain: 30\n...\n");
  const auto sensor = intake::SensorProcess::start(
      *intake::find_sensor_program(), arguments({.options = {"--settings", file}}, "ignore"), seconds{30});
  CHECK(!sensor.has_value());
  STRCMP_CONTAINS("set.yaml line 3, camera.gain: 0 to 24 expected, found 30",
                  to_line(sensor.error()).c_str());
}

TEST(Capture, WhatExcludesEachOtherIsRefusedInPlainWords) {
  cell = open_cell(settings_of({}));
  if (!cell) return;
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--second-exposure-us", "2000", "--laser-off-frames"},
        {"--auto-exposure", "--laser-off-frames"},
        {"--second-exposure-us", "10"}}) {
    const auto sensor = intake::SensorProcess::start(*intake::find_sensor_program(),
                                                     arguments({.options = options}, "ignore"), seconds{30});
    CHECK(!sensor.has_value());
    LONGS_EQUAL(static_cast<int>(ExitStatus::BadInput),
                static_cast<int>(error_row(sensor.error().code).exit_status));
  }
}

}  // namespace biteline::sim
