// SPDX-License-Identifier: MIT
#include "hal/linux/aravis/aravis_device.hpp"

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
  clock_health.rt_store({.known = true, .offset = -ptp_reading.offset, .uncertainty = ptp_reading.uncertainty});
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
