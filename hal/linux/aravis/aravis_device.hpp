// SPDX-License-Identifier: MIT
#pragma once
/// \file AravisCamera's inside: the one place besides it where Aravis' types are met.

#include <arv.h>

#include <atomic>
#include <cfenv>
#include <vector>

#include "common/rt/latest_value.hpp"
#include "hal/linux/aravis/aravis_camera.hpp"
#include "hal/linux/aravis/arrival_clock.hpp"
#include "hal/linux/aravis/frame_counter.hpp"
#include "hal/timing/clock_map.hpp"

namespace biteline::hal {

/// The arithmetic flags stay as they were: Aravis divides by zero in passing (a frame rate of a period not
/// read yet, a mean rate over no frames), and those flags are not this program's.
class KeepFloatingPointFlags {
 public:
  KeepFloatingPointFlags() { std::feholdexcept(&environment_); }
  ~KeepFloatingPointFlags() { std::fesetenv(&environment_); }
  KeepFloatingPointFlags(const KeepFloatingPointFlags&) = delete;
  KeepFloatingPointFlags& operator=(const KeepFloatingPointFlags&) = delete;

 private:
  std::fenv_t environment_{};
};

/// The one funnel from GError to Error.
class Call {
 public:
  explicit Call(const std::string& device, const char* what) : device_(device), what_(what) {}
  ~Call() { g_clear_error(&error_); }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  operator GError**() {
    return &error_;
  }  // NOLINT(google-explicit-constructor): it stands where a GError** is wanted
  [[nodiscard]] bool failed() const { return error_ != nullptr; }
  [[nodiscard]] tl::unexpected<Error> failure() const {
    const bool gone = g_error_matches(error_, ARV_DEVICE_ERROR, ARV_DEVICE_ERROR_NOT_CONNECTED) ||
                      g_error_matches(error_, ARV_DEVICE_ERROR, ARV_DEVICE_ERROR_TIMEOUT);
    const bool absent = g_error_matches(error_, ARV_DEVICE_ERROR, ARV_DEVICE_ERROR_NOT_FOUND);
    const Errc code = absent ? Errc::DeviceNotFound : gone ? Errc::DeviceLost : Errc::DeviceError;
    return fail(code, "camera %s, %s: %s", device_.c_str(), what_, error_->message);
  }

 private:
  KeepFloatingPointFlags flags_;
  const std::string& device_;
  const char* what_;
  GError* error_{nullptr};
};

/// Everything that belongs to one opened camera.
struct AravisCamera::Device {
  Config config;
  ArvCamera* camera{nullptr};
  ArvStream* stream{nullptr};
  enum class State { Open, Configured, Running };
  State state{State::Open};
  CameraSettings settings;
  bool ptp{false};
  /// The last adjust_exposure(): what held before, and between which instants the camera took the new one.
  Nanoseconds exposure_before{0};
  SensorClock::time_point change_from{SensorClock::time_point::min()},
      change_until{SensorClock::time_point::min()};
  std::vector<ArvBuffer*> borrowed;
  ArrivalClock arrival;
  ClockMapCore arrival_line{ClockMapCore::Config{}};
  ReferenceClock::Reading ptp_reading;  ///< offset 0 without a clock to read
  rt::LatestValue<ClockHealth> clock_health;
  FrameCounter counter;
  std::uint64_t next_sequence{0};
  std::size_t payload_bytes{0};  ///< room in a buffer of the present stream
  std::uint64_t passed_over{0};  ///< buffers since the last frame that was given out
  RowRange rows;                 ///< of settings.region that frames show now
  RowRange rows_before;          ///< what they showed before the last change: of another height
  int row_step_px{1};
  /// Frames before the present stream's first (adjust_rows() makes a new one), and when the last of them was.
  std::uint64_t base_sequence{0};
  SensorClock::time_point last_mid{SensorClock::time_point::min()};
  std::atomic<bool> lost{false};
  std::atomic<std::uint64_t> frames{0}, frames_lost{0}, frames_damaged{0};
  std::atomic<std::uint64_t> underruns{0}, packets_resent{0};
  std::atomic<float> temperature_degc{0};
  std::atomic<bool> temperature_known{false};

  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() {
    drop_stream();
    if (camera == nullptr) return;
    g_signal_handlers_disconnect_by_data(arv_camera_get_device(camera), this);
    g_object_unref(camera);
  }

  void drop_stream() {
    for (ArvBuffer* buffer : borrowed) g_object_unref(buffer);
    borrowed.clear();
    const KeepFloatingPointFlags flags;
    if (stream != nullptr) g_object_unref(stream);
    stream = nullptr;
  }

  /// Number of a buffer whose leader has not come; no frame's own: GigE Vision counts from 1, USB3 Vision
  /// from 0.
  static constexpr guint64 k_no_number = ~guint64{0};
  /// Gives a buffer to Aravis.  It is marked first: where a leader is lost, Aravis leaves number and stamp of
  /// the frame before in it.
  void push(ArvBuffer* buffer) const {
    arv_buffer_set_frame_id(buffer, k_no_number);
    arv_buffer_set_timestamp(buffer, 0);
    arv_stream_push_buffer(stream, buffer);
  }
  /// Frames that the camera took before the present stream's first one and that nobody numbered: those that
  /// came broken, and after a change of the rows those that were not taken meanwhile, which came at a rate.
  [[nodiscard]] std::uint64_t frames_before_first(SensorClock::time_point first_mid) const;

  [[nodiscard]] bool has(const char* feature) const {
    const KeepFloatingPointFlags flags;
    GError* error = nullptr;
    const bool present =
        arv_camera_is_feature_available(camera, feature, &error) != FALSE && error == nullptr;
    g_clear_error(&error);
    return present;
  }

  /// Of the picture in which regions are counted: of a binned sensor less than it has.
  Result<void> full_size(int& width_px, int& height_px) const;
  Result<void> set_trigger(Trigger trigger);
  Result<void> set_rate(double rate_hz);
  /// Rows of a frame by its height; height 0: of no known rows, taken in mid change.
  [[nodiscard]] RowRange rows_of(int height_px) const {
    if (height_px == rows.height_px) return rows;
    return height_px == rows_before.height_px ? rows_before : RowRange{};
  }
  /// While it runs, if the camera lets.
  bool change_rows(const RowRange& wanted);
  Result<void> set_sequence();
  Result<void> begin_sequence();
  /// Of `settings`: two sets in turn.
  [[nodiscard]] bool sequenced() const {
    return settings.second_exposure.count() != 0 || settings.laser_off_frames;
  }
  /// Exposure of the frame that began then; sets `unsure` when that lies within a change of the exposure.
  [[nodiscard]] Nanoseconds exposure_of(SensorClock::time_point begin, bool& unsure) const {
    unsure = unsure || (begin > change_from && begin < change_until);
    return begin <= change_from ? exposure_before : settings.exposure;
  }
  Result<void> set_region(const geometry::Region& region);
  Result<geometry::Region> region() const;
  void read_counts();
  void read_ptp();
  /// How the PTP time lies on our clock now; the former reading stays when it cannot be read.
  void measure_ptp();
  /// The instant of the camera's own stamp on the sensor's clock.
  SensorClock::time_point to_sensor(Nanoseconds stamp, SensorClock::time_point arrived);
  void read_temperature();
};

}  // namespace biteline::hal
