// SPDX-License-Identifier: MIT
#pragma once
/// \file The camera that looks at the laser line.

#include <optional>

#include "common/core/result.hpp"
#include "common/geometry/camera_state.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/profile/counts.hpp"
#include "hal/api/clock_health.hpp"
#include "hal/api/frame.hpp"

namespace biteline::hal {

enum class Trigger {
  FreeRun,   ///< the camera's own rate
  Hardware,  ///< one frame per edge on its trigger line (PwmOut or the robot's encoder)
};

struct CameraSettings {
  geometry::Region region;  ///< part of the full sensor that frames show
  Nanoseconds exposure{0};
  /// Frames per second in free run; with a hardware trigger the highest rate to be expected.
  double rate_hz{0};
  Trigger trigger{Trigger::FreeRun};
  /// Every second frame with this exposure instead (bracketing; flagged k_frame_second_exposure); 0: off.
  Nanoseconds second_exposure{0};
  /// Every second frame without the laser (the camera's strobe output, on which the laser's modulation hangs,
  /// stays off; flagged k_frame_laser_off).  Not beside second_exposure.
  bool laser_off_frames{false};
  /// The camera's own number: dB on GenICam, the driver's steps on V4L2.  None: as the camera has it.
  std::optional<double> gain{};
};

/// Rows of the configured region.
struct RowRange {
  int first_px{0};
  int height_px{0};
};

struct CameraLimits {
  int sensor_width_px{0}, sensor_height_px{0};
  int region_step_u_px{1}, region_step_v_px{1};  ///< offsets and sizes are multiples of these
  Nanoseconds exposure_min{0}, exposure_max{0};
  double gain_min{0}, gain_max{0};  ///< both 0: its gain cannot be set
  std::optional<double> gain{};     ///< as it is now; none: not known
  double rate_max_hz{0};            ///< at the region and exposure now configured (full sensor before that)
  bool hardware_trigger{false};
  bool bracketing{false};  ///< second_exposure and laser_off_frames: two sets of settings in turn
  bool rows_adjustable{false};
};

/// What a camera's strobe echo shows of its trigger; counts since start().
struct TriggerHealth : profile::TriggerCounts {
  bool watched{false};  ///< there is a strobe echo, and frames are tied to its edges
};

/// Counts since start(), except `finished`.
struct CameraHealth {
  std::uint64_t frames{0};          ///< given out whole
  std::uint64_t frames_lost{0};     ///< gaps in the camera's own count
  std::uint64_t frames_damaged{0};  ///< given out with k_frame_damaged
  std::uint64_t underruns{0};       ///< no free buffer when a frame came
  std::uint64_t packets_resent{0};  ///< GigE Vision
  float temperature_degc{0};
  bool temperature_known{false};
  bool connected{true};
  bool finished{false};  ///< a finite source (a recording) has no further frame, now and for ever
  ClockHealth clock{};   ///< the camera's own clock, where stamps are mapped from one
  TriggerHealth trigger{};
};

/// Made by the backend's `static Result<std::unique_ptr<...>> open(config)`; destroyed in any state (stops
/// first).
///
/// | state      | configure  | start    | next_frame | release | adjust_*        | stop     |
/// |------------|------------|----------|------------|---------|-----------------|----------|
/// | Open       | Configured | refused  | refused    | -       | refused         | ok, Open |
/// | Configured | Configured | Running  | refused    | -       | refused         | ok       |
/// | Running    | refused    | refused  | Running    | Running | Running         | Configured |
///
/// refused: Errc::WrongState, nothing changes.  stop() in any state is harmless and invalidates every
/// borrowed frame. When the device is lost next_frame() says Errc::DeviceLost once and for ever; only stop()
/// is of use then. Thread: one owner at a time; health() from any thread. RT: next_frame() waits in the
/// kernel and is otherwise free of allocation after start(); release() never blocks.
class LineCamera {
 public:
  LineCamera() = default;
  LineCamera(const LineCamera&) = delete;
  LineCamera& operator=(const LineCamera&) = delete;
  virtual ~LineCamera() = default;

  [[nodiscard]] virtual Result<CameraLimits> limits() = 0;

  /// Frames a second that region and exposure allow now; 0: the camera does not tell.  One question: while
  /// frames come, limits() would ask a dozen.
  [[nodiscard]] virtual Result<double> rate_max_hz() {
    return limits().map([](const CameraLimits& limits) { return limits.rate_max_hz; });
  }

  /// Sets what is told of `wanted` (geometry::CameraState; sizes and pixel format are chosen by configure())
  /// and reads everything back; what is not told stays as another program left it.  A value that the device
  /// refuses is read and no error: who knows the calibration compares.  Before configure(): sizes hang on it.
  [[nodiscard]] virtual Result<geometry::CameraState> set_state(const geometry::CameraState& wanted) {
    (void)wanted;
    return state();
  }

  /// As the device tells it now; what it cannot tell is not told.
  [[nodiscard]] virtual Result<geometry::CameraState> state() { return geometry::CameraState{}; }

  /// Gives back what the device really took (steps, rate limits); refuses with Errc::BadValue what it cannot
  /// come near (region outside the sensor, exposure beyond its range).
  [[nodiscard]] virtual Result<CameraSettings> configure(const CameraSettings& wanted) = 0;

  [[nodiscard]] virtual Result<void> start() = 0;

  /// The next frame in order of exposure.  Errc::Timeout when none came within `timeout` (also at once when
  /// health().finished); a damaged frame is a frame, flagged.
  [[nodiscard]] virtual Result<FrameView> next_frame(Nanoseconds timeout) = 0;

  /// Gives a borrowed frame back.  Pre: it came from this camera and was not released yet.
  virtual void release(const FrameView& frame) noexcept = 0;

  /// For the frames from the next but two on at the latest.
  [[nodiscard]] virtual Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) = 0;

  /// Frames from now on show only these rows of the configured region (FrameView::first_row_px), to within
  /// the camera's steps; gives back what it took.  May cost a few frames, counted as lost.  Pre: no frame is
  /// borrowed.
  [[nodiscard]] virtual Result<RowRange> adjust_rows(const RowRange& rows) {
    (void)rows;
    return fail(Errc::NotSupported, "this camera's region stands while it runs");
  }

  [[nodiscard]] virtual Result<void> stop() = 0;

  [[nodiscard]] virtual CameraHealth health() const noexcept = 0;
};

}  // namespace biteline::hal
