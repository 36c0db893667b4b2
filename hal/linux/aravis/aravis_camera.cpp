// SPDX-License-Identifier: MIT
#include "hal/linux/aravis/aravis_camera.hpp"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "hal/linux/aravis/aravis_device.hpp"
#include "hal/linux/aravis/receive_buffer.hpp"

namespace biteline::hal {

namespace {

/// The stream's own statistics are looked at this often.
constexpr std::uint64_t k_frames_between_counts = 32;

SensorClock::time_point monotonic_now() {
  return SensorClock::time_point{
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}

double microseconds(Nanoseconds time) {
  return static_cast<double>(time.count()) * 1e-3;
}
Nanoseconds from_microseconds(double time_us) {
  return Nanoseconds{std::llround(time_us * 1e3)};
}

int rounded_down(int value, int step) {
  return value - value % std::max(1, step);
}

/// Called by the receiving thread; frames themselves are popped and not taken here.
void on_receive_thread(void* priority, ArvStreamCallbackType what, ArvBuffer*) {
  if (what != ARV_STREAM_CALLBACK_TYPE_INIT) return;
  pthread_setname_np(pthread_self(), "bl-receive");
  const sched_param wanted{.sched_priority = *static_cast<const int*>(priority)};
  // Refused without the rights, which those who start the other threads have asked for already.
  if (wanted.sched_priority > 0) pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
}

/// GigE Vision has one application control a camera until it misses its heartbeat.
Result<void> expect_control(ArvGvDevice* handle, const std::string& address) {
  if (arv_gv_device_is_controller(handle) != FALSE) return {};
  constexpr guint32 k_heartbeat_timeout = 0x938, k_usual_ms = 3000;
  Call call(address, "heartbeat");
  guint32 timeout_ms = 0;
  arv_device_read_register(ARV_DEVICE(handle), k_heartbeat_timeout, &timeout_ms, call);
  if (call.failed()) timeout_ms = k_usual_ms;
  return fail(Errc::DeviceError,
              "camera %s: another program controls it; one that died does so for %.1f s without a heartbeat",
              address.c_str(), 1e-3 * timeout_ms);
}

}  // namespace

AravisCamera::AravisCamera(std::unique_ptr<Device> device) : device_(std::move(device)) {}

AravisCamera::~AravisCamera() {
  if (device_->state == Device::State::Running && !stop()) {
    // Gone or silent: the heartbeat ends and the camera stops by itself.
  }
}

Result<std::unique_ptr<AravisCamera>> AravisCamera::open(const Config& config) {
  auto device = std::make_unique<Device>();
  device->config = config;
  Call call(device->config.address, "open");
  device->camera = arv_camera_new(config.address.c_str(), call);
  if (call.failed()) return call.failure();
  if (device->camera == nullptr) return fail(Errc::DeviceNotFound, "camera %s", config.address.c_str());

  ArvDevice* handle = arv_camera_get_device(device->camera);
  g_signal_connect(handle, "control-lost",
                   G_CALLBACK(+[](ArvDevice*, gpointer self) { static_cast<Device*>(self)->lost = true; }),
                   device.get());
  if (ARV_IS_GV_DEVICE(handle)) {
    BITELINE_TRY(expect_control(ARV_GV_DEVICE(handle), config.address));
    arv_gv_device_set_stream_options(
        ARV_GV_DEVICE(handle),
        config.packet_socket ? ARV_GV_STREAM_OPTION_NONE : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    // Aravis 0.8.26 misjudges small payloads when it looks for a packet size by itself.
    arv_gv_device_set_packet_size_adjustment(ARV_GV_DEVICE(handle), ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    if (config.packet_bytes > 0) arv_camera_gv_set_packet_size(device->camera, config.packet_bytes, call);
    if (call.failed()) return call.failure();
  }
  // One that a program left running goes on to where that program was, and refuses other settings.
  arv_camera_stop_acquisition(device->camera, call);
  if (!call.failed()) arv_camera_set_pixel_format(device->camera, ARV_PIXEL_FORMAT_MONO_8, call);
  if (!call.failed()) arv_camera_set_acquisition_mode(device->camera, ARV_ACQUISITION_MODE_CONTINUOUS, call);
  if (call.failed()) return call.failure();
  if (device->has("PtpEnable")) {
    arv_camera_set_boolean(device->camera, "PtpEnable", TRUE, call);
    if (call.failed()) return call.failure();
  }
  device->read_ptp();
  device->read_temperature();
  return std::unique_ptr<AravisCamera>(new AravisCamera(std::move(device)));
}

Result<CameraLimits> AravisCamera::limits() {
  Call call(device_->config.address, "limits");
  CameraLimits limits;
  ArvCamera* camera = device_->camera;
  BITELINE_TRY(device_->full_size(limits.sensor_width_px, limits.sensor_height_px));
  limits.region_step_u_px = std::max(arv_camera_get_width_increment(camera, nullptr),
                                     arv_camera_get_x_offset_increment(camera, nullptr));
  limits.region_step_v_px = std::max(arv_camera_get_height_increment(camera, nullptr),
                                     arv_camera_get_y_offset_increment(camera, nullptr));
  limits.region_step_u_px = std::max(1, limits.region_step_u_px);
  limits.region_step_v_px = std::max(1, limits.region_step_v_px);
  double low_us = 0, high_us = 0;
  arv_camera_get_exposure_time_bounds(camera, &low_us, &high_us, call);
  if (call.failed()) return call.failure();
  limits.exposure_min = from_microseconds(low_us);
  limits.exposure_max = from_microseconds(std::min(high_us, 1e9));
  if (device_->has("Gain")) {
    arv_camera_get_gain_bounds(camera, &limits.gain_min, &limits.gain_max, call);
    if (!call.failed()) limits.gain = arv_camera_get_gain(camera, call);
    if (call.failed()) return call.failure();
  }
  BITELINE_ASSIGN(limits.rate_max_hz, rate_max_hz());
  limits.hardware_trigger = device_->has("TriggerMode");
  limits.bracketing = device_->has("SequencerMode");
  limits.rows_adjustable = true;
  return limits;
}

Result<double> AravisCamera::rate_max_hz() {
  double low_hz = 0, high_hz = 0;
  if (!device_->has("AcquisitionFrameRate")) return high_hz;
  Call call(device_->config.address, "rate_max_hz");
  arv_camera_get_frame_rate_bounds(device_->camera, &low_hz, &high_hz, call);
  if (call.failed()) return call.failure();
  return high_hz;
}

Result<CameraSettings> AravisCamera::configure(const CameraSettings& wanted) {
  Device& device = *device_;
  if (device.state == Device::State::Running)
    return fail(Errc::WrongState, "camera %s: configure while running", device.config.address.c_str());
  const bool bracket = wanted.second_exposure.count() != 0;
  if (bracket && wanted.laser_off_frames) {
    return fail(Errc::InvalidArgument, "camera %s: a second exposure and laser-off frames exclude each other",
                device.config.address.c_str());
  }
  BITELINE_ASSIGN(const CameraLimits limit, limits());
  const geometry::Region& r = wanted.region;
  if (r.offset_u_px < 0 || r.offset_v_px < 0 || r.width_px < 1 || r.height_px < 1 ||
      r.offset_u_px + r.width_px > limit.sensor_width_px ||
      r.offset_v_px + r.height_px > limit.sensor_height_px) {
    return fail(Errc::BadValue, "camera %s: region %d x %d at (%d, %d) outside its %d x %d pixels",
                device.config.address.c_str(), r.width_px, r.height_px, r.offset_u_px, r.offset_v_px,
                limit.sensor_width_px, limit.sensor_height_px);
  }
  for (const Nanoseconds exposure : {wanted.exposure, bracket ? wanted.second_exposure : wanted.exposure}) {
    if (exposure < limit.exposure_min || exposure > limit.exposure_max) {
      return fail(Errc::BadValue, "camera %s: exposure %.1f us outside %.1f to %.1f us",
                  device.config.address.c_str(), microseconds(exposure), microseconds(limit.exposure_min),
                  microseconds(limit.exposure_max));
    }
  }
  if (wanted.gain && !(*wanted.gain >= limit.gain_min && *wanted.gain <= limit.gain_max)) {
    return fail(Errc::BadValue, "camera %s: gain %g outside %g to %g", device.config.address.c_str(),
                *wanted.gain, limit.gain_min, limit.gain_max);
  }
  const geometry::Region stepped{.offset_u_px = rounded_down(r.offset_u_px, limit.region_step_u_px),
                                 .offset_v_px = rounded_down(r.offset_v_px, limit.region_step_v_px),
                                 .width_px = rounded_down(r.width_px, limit.region_step_u_px),
                                 .height_px = rounded_down(r.height_px, limit.region_step_v_px)};
  BITELINE_TRY(device.set_region(stepped));
  device.settings = wanted;
  BITELINE_TRY(device.set_sequence());
  Call call(device.config.address, "exposure");
  arv_camera_set_exposure_time(device.camera, microseconds(wanted.exposure), call);
  if (!call.failed() && wanted.gain) arv_camera_set_gain(device.camera, *wanted.gain, call);
  if (call.failed()) return call.failure();
  if (wanted.trigger == Trigger::FreeRun) BITELINE_TRY(device.set_rate(wanted.rate_hz));
  BITELINE_TRY(device.set_trigger(wanted.trigger));

  BITELINE_ASSIGN(device.settings.region, device.region());
  device.settings.exposure = from_microseconds(arv_camera_get_exposure_time(device.camera, call));
  if (!call.failed() && wanted.gain) device.settings.gain = arv_camera_get_gain(device.camera, call);
  if (call.failed()) return call.failure();
  if (wanted.trigger == Trigger::FreeRun && wanted.rate_hz > 0) {
    device.settings.rate_hz = arv_camera_get_frame_rate(device.camera, call);
    if (call.failed()) return call.failure();
  }
  device.state = Device::State::Configured;
  return device.settings;
}

Result<void> AravisCamera::start() {
  Device& device = *device_;
  if (device.state != Device::State::Configured)
    return fail(Errc::WrongState, "camera %s: start before configure", device.config.address.c_str());
  device.rows = device.rows_before = {.first_px = 0, .height_px = device.settings.region.height_px};
  BITELINE_ASSIGN(const CameraLimits limit, limits());
  device.row_step_px = limit.region_step_v_px;
  device.next_sequence = device.base_sequence = 0;
  device.last_mid = SensorClock::time_point::min();
  device.arrival.reset();
  device.arrival_line = ClockMapCore{ClockMapCore::Config{}};
  device.frames = device.frames_lost = device.frames_damaged = device.underruns = device.packets_resent = 0;
  device.change_from = device.change_until = SensorClock::time_point::min();
  device.read_ptp();
  device.measure_ptp();
  device.read_temperature();
  BITELINE_TRY(begin_stream());
  device.state = Device::State::Running;
  return {};
}

Result<void> AravisCamera::begin_stream() {
  Device& device = *device_;
  Call call(device.config.address, "start");
  device.stream =
      arv_camera_create_stream(device.camera, on_receive_thread, &device.config.receive_priority, call);
  if (call.failed()) return call.failure();
  const guint payload_bytes = arv_camera_get_payload(device.camera, call);
  if (call.failed()) return call.failure();
  if (ARV_IS_GV_STREAM(device.stream)) {
    // A burst of whole frames fits the socket, so that a receiver that is late by a frame loses none.  Aravis
    // would enlarge it with the first packet, when the rest of the first frame is on its way: 0, leave it.
    g_object_set(device.stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", 0,
                 nullptr);
    const auto burst_bytes = static_cast<int>(std::min<std::uint64_t>(16ULL * payload_bytes, 64ULL << 20U));
    const guint16 port = arv_gv_stream_get_port(ARV_GV_STREAM(device.stream));
    if (const Result<int> room = enlarge_receive_buffer(port, burst_bytes); !room) {
      device.drop_stream();
      return tl::unexpected<Error>{room.error()};
    }
    // A frame that waits for missing packets holds back all after it.  Aravis' own 200 ms would count as a
    // camera that gives no frames (the laser's guard allows 75 ms): give such a frame up, flagged, well
    // before that.
    constexpr guint k_frame_retention_us = 40'000, k_packet_timeout_us = 15'000;
    g_object_set(device.stream, "frame-retention", k_frame_retention_us, "packet-timeout",
                 k_packet_timeout_us, nullptr);
  }
  for (int i = 0; i < device.config.buffers; ++i) {
    ArvBuffer* buffer = arv_buffer_new_allocate(payload_bytes);
    std::size_t size_bytes = 0;
    void* data = const_cast<void*>(arv_buffer_get_data(buffer, &size_bytes));
    std::memset(data, 0, payload_bytes);  // touched now, not while frames flow
    device.push(buffer);
  }
  device.borrowed.reserve(static_cast<std::size_t>(device.config.buffers));
  device.counter = {};
  device.payload_bytes = payload_bytes;
  device.passed_over = 0;
  if (const Result<void> begun = device.begin_sequence(); !begun) {
    device.drop_stream();
    return begun;
  }
  arv_camera_start_acquisition(device.camera, call);
  if (call.failed()) {
    device.drop_stream();
    return call.failure();
  }
  return {};
}

Result<FrameView> AravisCamera::next_frame(Nanoseconds timeout) {
  Device& device = *device_;
  if (device.state != Device::State::Running)
    return fail(Errc::WrongState, "camera %s: not running", device.config.address.c_str());
  const auto until = monotonic_now() + timeout;
  for (;;) {
    if (device.lost) return fail(Errc::DeviceLost, "camera %s", device.config.address.c_str());
    const auto left = std::max<std::int64_t>(0, (until - monotonic_now()).count() / 1000);
    ArvBuffer* buffer = arv_stream_timeout_pop_buffer(device.stream, static_cast<guint64>(left));
    const auto arrival = monotonic_now();
    if (buffer == nullptr) {
      device.read_counts();
      if (device.lost) return fail(Errc::DeviceLost, "camera %s", device.config.address.c_str());
      return fail(Errc::Timeout, "camera %s: no frame", device.config.address.c_str());
    }
    const ArvBufferStatus status = arv_buffer_get_status(buffer);
    const bool whole = status == ARV_BUFFER_STATUS_SUCCESS;
    const bool holed = status == ARV_BUFFER_STATUS_MISSING_PACKETS || status == ARV_BUFFER_STATUS_TIMEOUT;
    const guint64 number = arv_buffer_get_frame_id(buffer);
    std::size_t size_bytes = 0;
    const auto* pixels = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size_bytes));
    // Aravis tells the size of whole frames alone: else that of the settings counts.
    if (!whole) size_bytes = device.payload_bytes;
    const int width_px = device.settings.region.width_px;
    const RowRange rows = device.rows_of(whole ? arv_buffer_get_image_height(buffer) : device.rows.height_px);
    const int height_px = rows.height_px;
    const std::size_t wanted_bytes = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
    const bool foreign = (whole && (arv_buffer_get_image_width(buffer) != width_px ||
                                    arv_buffer_get_image_height(buffer) != height_px)) ||
                         size_bytes < wanted_bytes;
    if ((!whole && !holed) || foreign || pixels == nullptr || number == Device::k_no_number) {
      // Aborted, of another size, or of a number and time that nobody knows: nothing to show.  Its gap shows
      // in the next one's number, or is counted here where that is the first.
      ++device.passed_over;
      device.push(buffer);
      continue;
    }
    FrameView frame{.pixels = {pixels, wanted_bytes},
                    .width_px = width_px,
                    .height_px = height_px,
                    .first_row_px = rows.first_px,
                    .stride_bytes = static_cast<std::size_t>(width_px),
                    .sequence = device.counter.count(number),
                    .exposure_mid = {},
                    .flags = whole ? 0U : static_cast<std::uint32_t>(k_frame_damaged)};
    // 0: a camera without a clock.  146 years: no clock's, and its difference to ours might not fit.
    constexpr std::uint64_t k_last_stamp_ns = std::uint64_t{1} << 62U;
    const std::uint64_t stamp_ns = arv_buffer_get_timestamp(buffer);
    const bool stamped = stamp_ns != 0 && stamp_ns < k_last_stamp_ns;
    const SensorClock::time_point begin =
        stamped ? device.to_sensor(Nanoseconds{static_cast<std::int64_t>(stamp_ns)}, arrival) : arrival;
    bool unsure = !device.ptp || !stamped;
    Nanoseconds exposure = device.exposure_of(begin, unsure);
    if (device.sequenced() && (device.counter.first_block() - 1 + frame.sequence) % 2 == 1) {
      frame.flags |= device.settings.laser_off_frames ? k_frame_laser_off : k_frame_second_exposure;
      if (!device.settings.laser_off_frames) exposure = device.settings.second_exposure;
    }
    frame.exposure_mid = begin + exposure / 2;
    if (unsure) frame.flags |= k_frame_stamp_uncertain;
    if (device.counter.fresh()) device.base_sequence += device.frames_before_first(frame.exposure_mid);
    device.passed_over = 0;
    device.last_mid = frame.exposure_mid;
    frame.sequence += device.base_sequence;
    if (frame.sequence > device.next_sequence) {
      frame.flags |= k_frame_gap_before;
      device.frames_lost += frame.sequence - device.next_sequence;
    }
    device.next_sequence = frame.sequence + 1;
    if (whole) {
      ++device.frames;
    } else {
      ++device.frames_damaged;
    }
    if (frame.sequence % k_frames_between_counts == 0) {
      device.read_counts();
      device.measure_ptp();
    }
    device.borrowed.push_back(buffer);
    return frame;
  }
}

void AravisCamera::release(const FrameView& frame) noexcept {
  Device& device = *device_;
  const auto found = std::find_if(device.borrowed.begin(), device.borrowed.end(), [&](ArvBuffer* buffer) {
    std::size_t size_bytes = 0;
    return arv_buffer_get_data(buffer, &size_bytes) == frame.pixels.data();
  });
  if (found == device.borrowed.end()) return;  // stop() took it back already
  device.push(*found);
  *found = device.borrowed.back();
  device.borrowed.pop_back();
}

Result<Nanoseconds> AravisCamera::adjust_exposure(Nanoseconds exposure) {
  Device& device = *device_;
  if (device.state != Device::State::Running)
    return fail(Errc::WrongState, "camera %s: not running", device.config.address.c_str());
  if (device.sequenced())
    return fail(Errc::NotSupported, "camera %s: its sequencer's exposures stand while it runs",
                device.config.address.c_str());
  Call call(device.config.address, "exposure");
  const auto from = monotonic_now();
  arv_camera_set_exposure_time(device.camera, microseconds(exposure), call);
  const auto until = monotonic_now();
  if (call.failed()) return call.failure();
  const Nanoseconds got = from_microseconds(arv_camera_get_exposure_time(device.camera, call));
  if (call.failed()) return call.failure();
  device.exposure_before = device.settings.exposure;
  device.settings.exposure = got;
  device.change_from = from;
  device.change_until = until;
  return got;
}

Result<RowRange> AravisCamera::adjust_rows(const RowRange& rows) {
  Device& device = *device_;
  if (device.state != Device::State::Running)
    return fail(Errc::WrongState, "camera %s: not running", device.config.address.c_str());
  const geometry::Region& whole = device.settings.region;
  if (rows.first_px < 0 || rows.height_px < 1 || rows.first_px + rows.height_px > whole.height_px) {
    return fail(Errc::BadValue, "camera %s: %d rows from row %d on of %d", device.config.address.c_str(),
                rows.height_px, rows.first_px, whole.height_px);
  }
  const RowRange wanted{.first_px = rounded_down(rows.first_px, device.row_step_px),
                        .height_px = rounded_down(rows.height_px, device.row_step_px)};
  if (wanted.first_px == device.rows.first_px && wanted.height_px == device.rows.height_px)
    return device.rows;
  if (device.change_rows(wanted)) return device.rows;
  // Sizes stand while it runs: a new acquisition.
  device.read_counts();
  {
    Call call(device.config.address, "stop");
    arv_camera_stop_acquisition(device.camera, call);
    if (call.failed()) return call.failure();
  }
  device.drop_stream();
  BITELINE_TRY(device.set_region({.offset_u_px = whole.offset_u_px,
                                  .offset_v_px = whole.offset_v_px + wanted.first_px,
                                  .width_px = whole.width_px,
                                  .height_px = wanted.height_px}));
  BITELINE_ASSIGN(const geometry::Region got, device.region());
  device.rows =
      device.rows_before = {.first_px = got.offset_v_px - whole.offset_v_px, .height_px = got.height_px};
  device.base_sequence = device.next_sequence;
  BITELINE_TRY(begin_stream());
  return device.rows;
}

Result<void> AravisCamera::stop() {
  Device& device = *device_;
  if (device.state != Device::State::Running) return {};
  device.read_counts();
  device.state = Device::State::Configured;
  Call call(device.config.address, "stop");
  if (!device.lost) arv_camera_stop_acquisition(device.camera, call);
  device.drop_stream();
  if (call.failed()) return call.failure();
  return {};
}

CameraHealth AravisCamera::health() const noexcept {
  const Device& device = *device_;
  return {.frames = device.frames,
          .frames_lost = device.frames_lost,
          .frames_damaged = device.frames_damaged,
          .underruns = device.underruns,
          .packets_resent = device.packets_resent,
          .temperature_degc = device.temperature_degc,
          .temperature_known = device.temperature_known,
          .connected = !device.lost,
          .finished = false,
          .clock = device.clock_health.rt_load().value_or(ClockHealth{})};
}

bool AravisCamera::clock_follows_ptp() const noexcept {
  return device_->ptp;
}

}  // namespace biteline::hal
