// SPDX-License-Identifier: MIT
#include "firmware/app/live_head.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "common/config/sensor_yaml.hpp"

namespace biteline::sensor {
namespace {

using settings::Key;
using settings::SettingsSet;

double microseconds(Nanoseconds duration) {
  return 1e-3 * static_cast<double>(duration.count());
}

Nanoseconds of_microseconds(double us) {
  return Nanoseconds{std::llround(1e3 * us)};
}

bool same(const geometry::Region& a, const geometry::Region& b) {
  return a.offset_u_px == b.offset_u_px && a.offset_v_px == b.offset_v_px && a.width_px == b.width_px &&
         a.height_px == b.height_px;
}

/// A refusal under the set's own line where the set asked for it; else of the camera.
tl::unexpected<Error> refuse(const LiveSettings& wanted, Key key, const std::string& expected) {
  if (wanted.set && wanted.set->at(key)) return wanted.set->refuse(key, expected);
  return fail(Errc::BadValue, "camera, %s: %s expected", settings::path_of(key).c_str(), expected.c_str());
}

std::string range_text(double low, double high, const char* unit) {
  char text[96];
  std::snprintf(text, sizeof text, "%.6g to %.6g%s%s", low, high, *unit == 0 ? "" : " ", unit);
  return text;
}

struct Span {
  Key offset, size;
  int offset_px, size_px, step_px, sensor_px;
};

Result<void> check_span(const LiveSettings& wanted, const Span& span) {
  const auto steps = [&](const char* range) {
    return std::string{range} + (span.step_px > 1 ? " in steps of " + std::to_string(span.step_px) : "");
  };
  if (span.offset_px % span.step_px != 0) return refuse(wanted, span.offset, steps("px"));
  if (span.size_px % span.step_px != 0) return refuse(wanted, span.size, steps("px"));
  if (span.sensor_px > 0 && span.offset_px + span.size_px > span.sensor_px)
    return refuse(wanted, span.size,
                  "at most " + std::to_string(span.sensor_px - span.offset_px) + " px there");
  return {};
}

/// What the camera says it took, against what was asked.
Result<void> check_taken(hal::LineCamera& camera, const LiveSettings& wanted,
                         const hal::CameraSettings& taken) {
  constexpr double k_gain_tolerance = 0.5;  // cameras count them in steps
  constexpr double k_rate_tolerance_ratio = 0.01;
  const hal::CameraSettings& asked = wanted.camera;
  if (!same(taken.region, asked.region)) {
    const geometry::Region& region = taken.region;
    return fail(Errc::DeviceError, "camera: its region is %d x %d at %d, %d instead of %d x %d at %d, %d",
                region.width_px, region.height_px, region.offset_u_px, region.offset_v_px,
                asked.region.width_px, asked.region.height_px, asked.region.offset_u_px,
                asked.region.offset_v_px);
  }
  if (!wanted.set) return {};
  const double taken_us = microseconds(taken.exposure);
  if (!is_as_asked(asked.exposure, taken.exposure))
    return refuse(wanted, Key::ExposureUs, "what the camera takes, " + range_text(taken_us, taken_us, "us"));
  if (asked.gain && std::abs(taken.gain.value_or(0) - *asked.gain) > k_gain_tolerance)
    return refuse(wanted, Key::Gain, "what the camera takes");
  if (!wanted.set->at(Key::RateHz)) return {};
  BITELINE_ASSIGN(const hal::CameraLimits now, camera.limits());
  const double most_hz =
      asked.trigger == hal::Trigger::FreeRun && taken.rate_hz > 0 ? taken.rate_hz : now.rate_max_hz;
  if (most_hz > 0 && most_hz < (1 - k_rate_tolerance_ratio) * asked.rate_hz)
    return refuse(wanted, Key::RateHz, range_text(0, most_hz, "Hz") + " at this region and exposure");
  return {};
}

}  // namespace

Result<void> check_limits(const LiveSettings& wanted, const hal::CameraLimits& limits) {
  const hal::CameraSettings& camera = wanted.camera;
  const geometry::Region& region = camera.region;
  BITELINE_TRY(check_span(wanted, {Key::RegionLeft, Key::RegionWidth, region.offset_u_px, region.width_px,
                                   limits.region_step_u_px, limits.sensor_width_px}));
  BITELINE_TRY(check_span(wanted, {Key::RegionTop, Key::RegionHeight, region.offset_v_px, region.height_px,
                                   limits.region_step_v_px, limits.sensor_height_px}));
  const double low_us = microseconds(limits.exposure_min), high_us = microseconds(limits.exposure_max);
  const auto holds = [&](Nanoseconds exposure) {
    return exposure >= limits.exposure_min && exposure <= limits.exposure_max;
  };
  // A driver that does not tell its range has none to be checked here.
  const bool range_known = limits.exposure_max > Nanoseconds{0};
  if (range_known && !holds(camera.exposure))
    return refuse(wanted, Key::ExposureUs, range_text(low_us, high_us, "us"));
  if (range_known && camera.second_exposure.count() != 0 && !holds(camera.second_exposure))
    return refuse(wanted, Key::SecondExposureUs, range_text(low_us, high_us, "us"));
  if (microseconds(camera.exposure) * camera.rate_hz > 1e6) {
    return refuse(wanted, wanted.set && wanted.set->at(Key::RateHz) ? Key::RateHz : Key::ExposureUs,
                  "an exposure shorter than a picture's period of " +
                      range_text(0, 1e6 / camera.rate_hz, "us").substr(5));
  }
  if (camera.second_exposure.count() != 0 && !limits.bracketing)
    return refuse(wanted, Key::SecondExposureUs,
                  "none: this camera has no two sets of settings in turn; none");
  if (camera.laser_off_frames && !limits.bracketing)
    return refuse(wanted, Key::LaserOffFrames, "off: this camera has no two sets of settings in turn; off");
  if (camera.gain && limits.gain_max <= limits.gain_min)
    return refuse(wanted, Key::Gain, "none: this camera's gain cannot be set; none");
  if (camera.gain && !NumberRange{limits.gain_min, limits.gain_max}.holds(*camera.gain))
    return refuse(wanted, Key::Gain, range_text(limits.gain_min, limits.gain_max, ""));
  if (wanted.set && wanted.set->on(Key::FollowStripe).value_or(false) && !limits.rows_adjustable)
    return refuse(wanted, Key::FollowStripe, "off: this camera's region stands while it runs; off");
  return {};
}

runtime::LaserGuard::Config guard_of(const hal::BoardLaser& laser) {
  if (!laser.patience) return {};
  return {.frames_within = *laser.patience,
          .watchdog_within = *laser.patience,
          .stream_within = *laser.patience,
          .looks_within = *laser.patience};
}

Result<void> check_lit_rate(const LiveSettings& wanted, const hal::Board& board) {
  constexpr double k_periods = 1.5;
  constexpr double k_rounding = 1e-9;
  if (!board.laser || board.trigger.kind == hal::BoardTrigger::Kind::Encoder) return {};
  const std::chrono::duration<double> within = guard_of(*board.laser).frames_within;
  const double least_hz = k_periods / within.count();
  if (wanted.camera.rate_hz >= (1 - k_rounding) * least_hz) return {};
  char expected[128];
  std::snprintf(expected, sizeof expected,
                "%.4g Hz or more (the laser goes dark after %.0f ms without a picture)", least_hz,
                1e3 * within.count());
  return refuse(wanted, Key::RateHz, expected);
}

bool is_as_asked(Nanoseconds asked, Nanoseconds taken) {
  constexpr double k_tolerance_ratio = 0.05, k_tolerance_us = 20;
  const double asked_us = microseconds(asked), taken_us = microseconds(taken);
  return taken_us <= 0 ||
         std::abs(taken_us - asked_us) <= std::max(k_tolerance_us, k_tolerance_ratio * asked_us);
}

Result<geometry::SensorModel> read_live_head(const std::filesystem::path& sensor_file,
                                             const std::optional<SettingsSet>& set) {
  BITELINE_ASSIGN(geometry::SensorModel head, config::read_sensor_yaml(sensor_file));
  return with_set(std::move(head), set, sensor_file);
}

Result<geometry::SensorModel> with_set(geometry::SensorModel head, const std::optional<SettingsSet>& set,
                                       const std::filesystem::path& file) {
  if (set) {
    if (const auto rate_hz = set->number(Key::RateHz)) head.rate_hz = rate_hz;
    if (const auto exposure_us = set->number(Key::ExposureUs)) head.exposure = of_microseconds(*exposure_us);
    if (const auto left = set->number(Key::RegionLeft)) {
      head.region = {.offset_u_px = static_cast<int>(*left),
                     .offset_v_px = static_cast<int>(*set->number(Key::RegionTop)),
                     .width_px = static_cast<int>(*set->number(Key::RegionWidth)),
                     .height_px = static_cast<int>(*set->number(Key::RegionHeight))};
    }
  }
  if (!head.rate_hz || !head.exposure || *head.rate_hz <= 0) {
    return fail(Errc::BadValue,
                "%s: rate_hz and exposure_ns are needed to run a camera, here or as rate_hz and exposure_us "
                "in --settings",
                file.c_str());
  }
  return head;
}

Capture put_over(const Capture& told, const SettingsSet& set) {
  Capture capture = told;
  capture.auto_exposure = told.auto_exposure || set.on(Key::AutoExposure).value_or(false);
  capture.follow_stripe = told.follow_stripe || set.on(Key::FollowStripe).value_or(false);
  capture.laser_off_frames = told.laser_off_frames || set.on(Key::LaserOffFrames).value_or(false);
  capture.test_pattern = told.test_pattern || set.on(Key::TestPattern).value_or(false);
  if (capture.second_exposure.count() == 0)
    capture.second_exposure = of_microseconds(set.number(Key::SecondExposureUs).value_or(0));
  return capture;
}

LiveSettings live_settings(const geometry::SensorModel& head, const Capture& capture, hal::Trigger trigger,
                           const std::optional<SettingsSet>& set) {
  return {.camera = {.region = head.region,
                     .exposure = *head.exposure,
                     .rate_hz = *head.rate_hz,
                     .trigger = trigger,
                     .second_exposure = capture.second_exposure,
                     .laser_off_frames = capture.laser_off_frames,
                     .gain = set ? set->number(Key::Gain) : std::nullopt},
          .set = set};
}

Result<hal::CameraSettings> configure_camera(hal::LineCamera& camera, const LiveSettings& wanted,
                                             const std::optional<hal::CameraSettings>& former) {
  std::optional<hal::CameraSettings> back = former;
  if (wanted.set) {
    BITELINE_ASSIGN(const hal::CameraLimits limits, camera.limits());
    BITELINE_TRY(check_limits(wanted, limits));
    // Former settings without a gain left it as the camera had it: that is told by number now.
    if (back && !back->gain && wanted.camera.gain) back->gain = limits.gain;
  }
  Result<hal::CameraSettings> taken = camera.configure(wanted.camera);
  Result<void> done;
  if (!taken) {
    done = tl::unexpected<Error>{taken.error()};
  } else {
    done = check_taken(camera, wanted, *taken);
  }
  if (done) return taken;
  if (back) {
    if (const Result<hal::CameraSettings> again = camera.configure(*back); !again) {
      std::fprintf(stderr, "biteline-sensor: the camera did not take its former settings again: %s\n",
                   to_line(again.error()).c_str());
    }
  }
  return tl::unexpected<Error>{done.error()};
}

hal::PwmSettings train_of(const geometry::SensorModel& head, const Capture& capture) {
  return {.period = Nanoseconds{static_cast<std::int64_t>(1e9 / *head.rate_hz)},
          .pulse = longest_exposure(capture, head)};
}

SettingsSet set_in_use(const hal::CameraSettings& taken, const geometry::SensorModel& head,
                       const Capture& capture) {
  SettingsSet set;
  const auto number = [&](Key key, double value) { set.set(key, {.number = value}); };
  const auto on = [&](Key key, bool value) { set.set(key, {.on = value}); };
  const Nanoseconds exposure = taken.exposure.count() != 0 ? taken.exposure : *head.exposure;
  number(Key::ExposureUs, microseconds(exposure));
  // A camera that runs by itself says how fast; another one as fast as its trigger, which is as asked.
  const bool told = taken.trigger == hal::Trigger::FreeRun && taken.rate_hz > 0;
  number(Key::RateHz, told ? taken.rate_hz : *head.rate_hz);
  if (taken.gain) number(Key::Gain, *taken.gain);
  if (capture.second_exposure.count() != 0)
    number(Key::SecondExposureUs, microseconds(capture.second_exposure));
  on(Key::AutoExposure, capture.auto_exposure);
  on(Key::FollowStripe, capture.follow_stripe);
  on(Key::LaserOffFrames, capture.laser_off_frames);
  // Only where it is on: hosts of 1.2 do not know the key.
  if (capture.test_pattern) on(Key::TestPattern, true);
  number(Key::RegionLeft, taken.region.offset_u_px);
  number(Key::RegionTop, taken.region.offset_v_px);
  number(Key::RegionWidth, taken.region.width_px);
  number(Key::RegionHeight, taken.region.height_px);
  return set;
}

}  // namespace biteline::sensor
