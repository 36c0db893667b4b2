// SPDX-License-Identifier: MIT
#pragma once
/// \file Single pictures with the arm's pose, for calibration: the camera runs, and one frame is kept on
/// demand.

#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "common/image/grey_image.hpp"
#include "firmware/app/board_devices.hpp"
#include "firmware/runtime/laser_watch.hpp"

namespace biteline::sensor {

/// Where the arm was, and how still.
struct Rest {
  int poses{0};                        ///< over the last 0.3 s; 0: none came
  SE3 T_base_flange{SE3::Identity()};  ///< their mean
  double moved_mm{0}, moved_rad{0};    ///< farthest of them from the mean
};

struct Still {
  image::GreyImage picture;
  Rest rest;                ///< up to the end of the exposure
  Nanoseconds exposure{0};  ///< as the camera took it; 0: its driver has no exposure control
};

/// Frames flow from open() to the end of the object, since the laser's guard wants them.  Light is asked for
/// while one lit picture is taken, and no longer.
/// Thread: one owner; a thread of its own reads poses.
class StillCamera {
 public:
  struct Config {
    double rate_hz{20};
    Nanoseconds exposure{10'000'000};  ///< at first
    runtime::RealtimeDemand realtime{runtime::RealtimeDemand::Required};
  };
  /// The whole sensor, whatever a head's region is.
  [[nodiscard]] static Result<std::unique_ptr<StillCamera>> open(const BoardDevices& devices,
                                                                 const hal::Clock& clock,
                                                                 runtime::LaserWatch* laser,
                                                                 const Config& config);
  ~StillCamera();
  StillCamera(const StillCamera&) = delete;
  StillCamera& operator=(const StillCamera&) = delete;

  /// Waits for one frame and lets it go: what keeps the guard content between pictures.
  [[nodiscard]] Result<void> idle();
  /// Errc::InterlockOpen: the guard gives no light, with its reason.  Errc::NotSupported: there is no laser.
  /// Errc::Timeout: no frame, or no whole one for 3 s.  Errc::WrongState: `stop` was set meanwhile.
  [[nodiscard]] Result<Still> take(Nanoseconds exposure, bool lit, const std::atomic<bool>& stop);
  [[nodiscard]] Rest rest() const;
  /// As the camera tells it: set to plain_state() where it takes that.
  [[nodiscard]] const geometry::CameraState& state() const { return state_; }

 private:
  StillCamera(const hal::Clock& clock, runtime::LaserWatch* laser) : clock_{clock}, laser_{laser} {}
  [[nodiscard]] Result<hal::FrameView> next_frame();
  [[nodiscard]] Result<void> wait_for_light();
  [[nodiscard]] Result<void> wait_for_exposure(Nanoseconds exposure);
  void read_poses();

  const hal::Clock& clock_;
  runtime::LaserWatch* laser_;
  std::unique_ptr<hal::LineCamera> camera_;
  std::unique_ptr<hal::PoseSource> poses_;  ///< null: it did not open
  std::unique_ptr<hal::PwmOut> trigger_;
  geometry::CameraState state_;
  Nanoseconds exposure_{0};
  bool fixed_exposure_{false};  ///< the driver tells no range of it
  std::thread pose_thread_;
  std::atomic<bool> stopping_{false};
  struct TimedPose {
    SensorClock::time_point received;
    SE3 T_base_flange;
  };
  mutable std::mutex mutex_;
  std::deque<TimedPose> recent_;  ///< guarded by mutex_
};

/// Obeys one order a line on stdin until it ends, and answers each by one line of JSON on stdout:
///
///     pose
///       {"ok":true,"poses":N,"pose":[x,y,z,qw,qx,qy,qz],"moved_mm":..,"moved_deg":..}
///     take dark|laser US FILE
///       the same, and "exposure_us", 0 where the driver has no exposure control; FILE is the picture (png)
///
/// What fails is answered too: {"ok":false,"error":"..."}; a device that is lost ends it.
[[nodiscard]] Result<void> serve_stills(StillCamera& camera, const std::atomic<bool>& stop);

}  // namespace biteline::sensor
