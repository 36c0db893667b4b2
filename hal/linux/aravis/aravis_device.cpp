// SPDX-License-Identifier: MIT
#include "hal/linux/aravis/aravis_device.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace biteline::hal {

Result<void> AravisCamera::Device::set_region(const geometry::Region& region) {
  Call call(config.address, "region");
  // Offsets first to 0: a larger size is refused beside the old offset.
  arv_camera_set_region(camera, 0, 0, region.width_px, region.height_px, call);
  if (call.failed()) return call.failure();
  arv_camera_set_region(camera, region.offset_u_px, region.offset_v_px, region.width_px, region.height_px,
                        call);
  if (call.failed()) return call.failure();
  return {};
}

/// A frame does not tell its place, but its height: rows in between differ from both in height and are thrown
/// away.
bool AravisCamera::Device::change_rows(const RowRange& wanted) {
  RowRange next = wanted;
  if (next.height_px == rows.height_px) {
    // One step more or less, so that the height tells old from new.
    const bool room = next.first_px + next.height_px + row_step_px <= settings.region.height_px;
    next.height_px += room ? row_step_px : -row_step_px;
  }
  const int between_px = std::min(next.height_px, rows.height_px) - row_step_px;
  if (between_px < 1) return false;
  Call call(config.address, "rows");
  arv_camera_set_integer(camera, "Height", between_px, call);
  if (call.failed()) return false;
  arv_camera_set_integer(camera, "OffsetY", settings.region.offset_v_px + next.first_px, call);
  if (!call.failed()) arv_camera_set_integer(camera, "Height", next.height_px, call);
  if (call.failed()) return false;
  rows_before = rows;
  rows = next;
  return true;
}

Result<geometry::Region> AravisCamera::Device::region() const {
  Call call(config.address, "region");
  geometry::Region region;
  arv_camera_get_region(camera, &region.offset_u_px, &region.offset_v_px, &region.width_px, &region.height_px,
                        call);
  if (call.failed()) return call.failure();
  return region;
}

Result<void> AravisCamera::Device::set_trigger(Trigger trigger) {
  Call call(config.address, "trigger");
  if (trigger == Trigger::FreeRun) {
    if (has("TriggerMode")) arv_camera_clear_triggers(camera, call);
  } else {
    if (!has("TriggerMode"))
      return fail(Errc::NotSupported, "camera %s has no TriggerMode", config.address.c_str());
    arv_camera_set_trigger(camera, config.trigger_line.c_str(), call);
  }
  if (call.failed()) return call.failure();
  return {};
}

Result<void> AravisCamera::Device::set_rate(double rate_hz) {
  if (rate_hz <= 0) return {};
  Call call(config.address, "frame rate");
  if (!has("AcquisitionFrameRate"))
    return fail(Errc::NotSupported, "camera %s has no AcquisitionFrameRate", config.address.c_str());
  if (has("AcquisitionFrameRateEnable"))
    arv_camera_set_boolean(camera, "AcquisitionFrameRateEnable", TRUE, call);
  if (!call.failed()) arv_camera_set_float(camera, "AcquisitionFrameRate", rate_hz, call);
  if (call.failed()) return call.failure();
  return {};
}

/// SFNC's sequencer with two sets, the second with another exposure or with the strobe output off.
Result<void> AravisCamera::Device::set_sequence() {
  if (!has("SequencerMode")) {
    if (!sequenced()) return {};
    return fail(Errc::NotSupported,
                "camera %s: no bracketing and no laser-off frames, it has no SequencerMode",
                config.address.c_str());
  }
  Call call(config.address, "sequencer");
  const auto choose = [&](const char* feature, const char* value) {
    if (!call.failed()) arv_camera_set_string(camera, feature, value, call);
  };
  const auto number = [&](const char* feature, int value) {
    if (!call.failed()) arv_camera_set_integer(camera, feature, value, call);
  };
  choose("SequencerMode", "Off");
  if (sequenced()) {
    choose("SequencerConfigurationMode", "On");
    for (const int set : {0, 1}) {
      const bool second = set == 1 && settings.second_exposure.count() != 0;
      number("SequencerSetSelector", set);
      if (!call.failed()) {
        const Nanoseconds exposure = second ? settings.second_exposure : settings.exposure;
        arv_camera_set_exposure_time(camera, static_cast<double>(exposure.count()) * 1e-3, call);
      }
      choose("LineSelector", config.strobe_line.c_str());
      choose("LineSource", set == 1 && settings.laser_off_frames ? "Off" : "ExposureActive");
      number("SequencerPathSelector", 0);
      number("SequencerSetNext", 1 - set);
      choose("SequencerTriggerSource", "ExposureEnd");
      if (!call.failed()) arv_camera_execute_command(camera, "SequencerSetSave", call);
    }
    number("SequencerSetSelector", 0);
    choose("SequencerConfigurationMode", "Off");
  }
  if (call.failed()) return call.failure();
  return {};
}

/// The first frame from now on is of set 0.
Result<void> AravisCamera::Device::begin_sequence() {
  if (!sequenced()) return {};
  Call call(config.address, "sequencer");
  arv_camera_set_integer(camera, "SequencerSetStart", 0, call);
  if (!call.failed()) arv_camera_set_string(camera, "SequencerMode", "On", call);
  if (call.failed()) return call.failure();
  return {};
}

std::uint64_t AravisCamera::Device::frames_before_first(SensorClock::time_point first_mid) const {
  if (last_mid == SensorClock::time_point::min()) return passed_over;
  const double away_s = 1e-9 * static_cast<double>((first_mid - last_mid).count());
  const long long by_rate = std::llround(away_s * settings.rate_hz) - 1;
  return std::max(passed_over, static_cast<std::uint64_t>(std::max(0LL, by_rate)));
}

void AravisCamera::Device::read_ptp() {
  ptp = false;
  if (!has("PtpStatus")) return;
  GError* error = nullptr;
  const char* status = arv_camera_get_string(camera, "PtpStatus", &error);
  if (error == nullptr && status != nullptr)
    ptp = std::strcmp(status, "Slave") == 0 || std::strcmp(status, "Master") == 0;
  g_clear_error(&error);
}

void AravisCamera::Device::measure_ptp() {
  if (!ptp) return;
  if (config.ptp_clock) {
    if (const auto reading = config.ptp_clock->measure()) ptp_reading = *reading;
  }
  clock_health.rt_store(
      {.known = true, .offset = -ptp_reading.offset, .uncertainty = ptp_reading.uncertainty});
}

SensorClock::time_point AravisCamera::Device::to_sensor(Nanoseconds stamp, SensorClock::time_point arrived) {
  if (ptp) return SensorClock::time_point{stamp - ptp_reading.offset};
  const SensorClock::time_point by_least_delay = arrival.map(stamp, arrived);
  arrival_line.add({.stamp_ns = stamp.count(), .received_ns = arrived.time_since_epoch().count()});
  clock_health.rt_store(hal::clock_health(arrival_line.health()));
  const std::optional<std::int64_t> on_line_ns = arrival_line.to_sensor_ns(stamp.count());
  return on_line_ns ? SensorClock::time_point{Nanoseconds{*on_line_ns}} : by_least_delay;
}

void AravisCamera::Device::read_temperature() {
  if (!has("DeviceTemperature")) return;
  GError* error = nullptr;
  const double degc = arv_camera_get_float(camera, "DeviceTemperature", &error);
  temperature_known = error == nullptr;
  if (error == nullptr) temperature_degc = static_cast<float>(degc);
  g_clear_error(&error);
}

void AravisCamera::Device::read_counts() {
  if (stream == nullptr) return;
  guint64 completed = 0, failures = 0, missing_buffers = 0;
  arv_stream_get_statistics(stream, &completed, &failures, &missing_buffers);
  underruns = missing_buffers;
  if (ARV_IS_GV_STREAM(stream)) {
    guint64 resent = 0, missing = 0;
    arv_gv_stream_get_statistics(ARV_GV_STREAM(stream), &resent, &missing);
    packets_resent = resent;
  }
}

}  // namespace biteline::hal
