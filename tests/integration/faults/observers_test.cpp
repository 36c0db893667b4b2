// SPDX-License-Identifier: MIT
// Observers beside the host: what they see is what the camera saw, and the scan does not know them.
#include <CppUTest/TestHarness.h>
#include <sched.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <memory>
#include <thread>
#include <vector>

#include "common/image/jpeg.hpp"
#include "common/wire/observer.hpp"
#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/long_tests.hpp"

namespace biteline::test {
namespace {

using std::chrono::milliseconds;

/// One observer on a thread of its own, as a viewer has it.
class Viewer {
 public:
  Viewer(const wire::Endpoint& sensor, const wire::PictureWish& picture)
      : thread_{[this, sensor, picture] { watch(sensor, picture); }} {}
  ~Viewer() { stop(); }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }

  /// Whether it has seen a scan's end and the sensor's health: they reach it when they will, also after the
  /// host.
  bool sees_the_end() const {
    for (int i = 0; i < 1000 && !(saw_health_ && saw_end_); ++i)
      std::this_thread::sleep_for(milliseconds{10});
    return saw_health_ && saw_end_;
  }

  // After stop().
  std::uint64_t pictures{0}, profiles{0}, bytes{0};
  int wrong{0};  ///< not decodable, older than the one before, or peaks off the stripe that the picture shows
  std::optional<Error> error;

 private:
  void watch(const wire::Endpoint& sensor, const wire::PictureWish& picture) {
    const sched_param ordinary{};  // whoever stands for a host is more urgent than a viewer
    sched_setscheduler(0, SCHED_OTHER, &ordinary);
    auto observer =
        wire::Observer::open({.sensor = sensor,
                              .keys = {},
                              .wish = {.name = "viewer", .profile_rate_hz = 20, .picture = picture}});
    if (!observer) {
      error = observer.error();
      return;
    }
    while (!stopping_) {
      const auto message = (*observer)->next(milliseconds{20});
      if (!message) {
        error = message.error();
        return;
      }
      if (!*message) continue;
      if (const auto* seen = std::get_if<wire::Picture>(&(*message)->body)) look_at(*seen);
      if (std::holds_alternative<profile::Profile>((*message)->body)) ++profiles;
      if (std::holds_alternative<wire::Health>((*message)->body)) saw_health_ = true;
      if (std::holds_alternative<wire::EndOfScan>((*message)->body)) saw_end_ = true;
    }
    wrong += static_cast<int>((*observer)->rejected());
  }

  void look_at(const wire::Picture& picture) {
    ++pictures;
    bytes += picture.pixels.size();
    const auto image = picture.format == wire::PictureFormat::Jpeg
                           ? image::decode_jpeg(picture.pixels)
                           : Result<image::GreyImage>{image::GreyImage{.width_px = picture.width_px(),
                                                                       .height_px = picture.height_px(),
                                                                       .pixels = picture.pixels}};
    const bool newer = pictures == 1 || picture.frame_sequence > last_frame_;
    last_frame_ = picture.frame_sequence;
    if (!image || !newer || image->width_px != picture.width_px() || !peaks_are_bright(picture, *image))
      ++wrong;
  }

  /// Where a peak was found the picture is brighter than ten rows of it away.
  static bool peaks_are_bright(const wire::Picture& picture, const image::GreyImage& image) {
    std::size_t bright = 0, looked_at = 0;
    for (const wire::PicturePeak& peak : picture.peaks) {
      const int x = static_cast<int>(std::lround(picture.x_of(peak.u_px)));
      const int y = static_cast<int>(std::lround(picture.y_of(peak.v_px)));
      const int beside = y + 10 < image.height_px ? y + 10 : y - 10;
      if (x < 0 || x >= image.width_px || y < 0 || y >= image.height_px || beside < 0) continue;
      ++looked_at;
      if (image.at(x, y) > image.at(x, beside)) ++bright;
    }
    // Noise and JPEG may take one in twenty.
    return 20 * bright >= 19 * looked_at;
  }

  std::uint64_t last_frame_{0};
  std::atomic<bool> stopping_{false}, saw_health_{false}, saw_end_{false};
  std::thread thread_;
};

/// What a stretch of a scan took, from the sensor's own stage times.
double mean_ms(const wire::EndOfScan& end, const std::string& stage) {
  for (const wire::StageTime& time : end.stages) {
    if (time.name == stage) return 1e-6 * static_cast<double>(time.mean.count());
  }
  return 0;
}

}  // namespace

TEST_GROUP(Observers) {
  static constexpr std::uint64_t k_profiles = 400;
  std::unique_ptr<FaultStand> stand;

  /// One scan of `k_profiles`, counted.
  bool scan() {
    const auto refused = stand->start_scan();
    CHECK_TEXT(!refused, refused.value_or("").c_str());
    const std::uint64_t until = stand->account().profiles + k_profiles;
    CHECK(stand->take_until([&] { return stand->account().profiles >= until || stand->account().end; }));
    if (!stand->account().end) stand->command(wire::Command::StopScan);
    return stand->take_end();
  }
  /// Every frame of the scan accounted for, none lost by the sensor.
  void nothing_is_missing() {
    const ScanAccount& account = stand->account();
    const wire::Counters& counters = account.end->counters;
    LONGS_EQUAL(0, account.end->errc);
    LONGS_EQUAL(0, account.wrong);
    LONGS_EQUAL(0, account.disordered);
    LONGS_EQUAL(0, account.lost);
    LONGS_EQUAL(0, counters.frames_lost);
    LONGS_EQUAL(0, counters.frames_damaged);
    LONGS_EQUAL(0, counters.profiles_dropped);
    LONGS_EQUAL(counters.frames, counters.profiles);
    LONGS_EQUAL(counters.profiles, account.profiles);
  }
};

LONG_GROUP(Observers){};

/// The same scan without and with five observers, who want every kind of picture at the highest rate.
TIMED_TEST(ObserversLong, FiveOfThemCostNoFrameAndTheHostNothing) {
  stand = FaultStand::set_up({.width_px = 1626, .height_px = 320, .rate_hz = 100});
  if (!stand) return;
  CHECK(scan());
  nothing_is_missing();
  const wire::EndOfScan alone = *stand->account().end;

  const wire::Endpoint sensor = stand->sensor().endpoint();
  const std::array<wire::PictureWish, 5> wishes{
      {{.rate_hz = 25, .width_max_px = 1626},
       {.rate_hz = 25, .width_max_px = 813, .format = wire::PictureFormat::Raw},
       {.rate_hz = 10, .width_max_px = 640},
       {.rate_hz = 10, .width_max_px = 640},
       {.rate_hz = 5,
        .width_max_px = 400,
        .region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 4000, .height_px = 4000}}}};
  std::vector<std::unique_ptr<Viewer>> viewers;
  for (const wire::PictureWish& wish : wishes) viewers.push_back(std::make_unique<Viewer>(sensor, wish));
  CHECK(scan());
  nothing_is_missing();
  const wire::EndOfScan watched = *stand->account().end;
  CHECK(stand->take_health());
  for (const std::unique_ptr<Viewer>& viewer : viewers) {
    CHECK(viewer->sees_the_end());
    viewer->stop();
  }
  for (const std::unique_ptr<Viewer>& viewer : viewers) {
    CHECK_TEXT(!viewer->error, viewer->error ? viewer->error->where.c_str() : "");
    LONGS_EQUAL(0, viewer->wrong);
    CHECK(viewer->pictures > 0);
    CHECK(viewer->profiles > 0);
    std::printf("a viewer took %llu pictures of %llu bytes and %llu profiles\n",
                static_cast<unsigned long long>(viewer->pictures),
                static_cast<unsigned long long>(viewer->bytes / viewer->pictures),
                static_cast<unsigned long long>(viewer->profiles));
  }
  // A picture shared by two wishes is copied out of the hot path once.
  for (const char* stage : {"frame_to_profile", "copy_picture", "stamp_pose", "encode"}) {
    std::printf("%s: %.3f ms alone, %.3f ms watched\n", stage, mean_ms(alone, stage),
                mean_ms(watched, stage));
  }
}

/// The laser does not shine on for somebody who only looks.
TIMED_TEST(Observers, OneAloneKeepsNoLaserOn) {
  stand = FaultStand::set_up();
  if (!stand) return;
  Viewer viewer{stand->sensor().endpoint(), {.rate_hz = 5}};
  const auto refused = stand->start_scan();
  CHECK_TEXT(!refused, refused.value_or("").c_str());
  const SensorClock::time_point left{std::chrono::steady_clock::now().time_since_epoch()};
  stand->leave();
  CHECK_TEXT(stand->dark_after_ms(left).has_value(), "the laser shines on");
  stand->come_back();
  CHECK(stand->take_end());
  LONGS_EQUAL(static_cast<int>(Errc::ConnectionLost), stand->account().end->errc);
  CHECK(viewer.sees_the_end());
  viewer.stop();
  CHECK(!viewer.error);
  CHECK(viewer.pictures > 0);
}

}  // namespace biteline::test
