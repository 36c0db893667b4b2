// SPDX-License-Identifier: MIT
#pragma once
/// \file Frames to profiles: the acquisition and the pose thread, and what they hand to the stream thread.

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "common/profile/counts.hpp"
#include "common/rt/buffer_pool.hpp"
#include "common/rt/drop_oldest_ring.hpp"
#include "firmware/app/capture.hpp"
#include "firmware/app/source.hpp"
#include "firmware/pipeline/picture_tap.hpp"
#include "firmware/pipeline/profile_pipeline.hpp"
#include "firmware/pipeline/record_tap.hpp"
#include "firmware/runtime/laser_watch.hpp"
#include "firmware/runtime/realtime.hpp"
#include "firmware/runtime/stage_meter.hpp"
#include "hal/api/clock.hpp"

namespace biteline::sensor {

/// One scan: two threads from start() to the end of the object.
///
///     camera -> [acquisition] rt_process -> ring of profiles -> [stream] take(), give_back()
///     poses  -> [pose] history ------------------------------------^ stamps them
///
/// A source that may wait (lossless) is made to: acquisition pauses while the ring is full, and poses are
/// read only as far ahead as the next profile needs, so that the history cannot run over.  Any other source
/// is never waited for: the oldest profile in the ring is dropped and counted. Thread: take() and give_back()
/// from the stream thread only; the rest from the thread that made it, the end from any.
class Scanner {
 public:
  struct Config {
    pipeline::ProfilePipeline::Config pipeline;
    geometry::SensorModel model;
    Capture capture{};
    bool lossless{false};  ///< the source may be made to wait
    runtime::RealtimeDemand realtime{runtime::RealtimeDemand::Required};
  };
  /// `laser` is told of every frame and every sign of life; null where there is none.
  [[nodiscard]] static Result<std::unique_ptr<Scanner>> create(Source source, const Config& config,
                                                               const hal::Clock& clock,
                                                               runtime::LaserWatch* laser);
  ~Scanner();  ///< stops first
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  /// Frames and poses go there as well.  Before start().
  void record_into(std::shared_ptr<pipeline::RecordTap> recording) { recording_ = std::move(recording); }
  [[nodiscard]] Result<void> start();
  /// Ends both threads; what is in the ring can still be taken.
  void stop();
  /// As stop(), without waiting for them.  Any thread.
  void request_stop() { stopping_ = true; }

  /// The next profile in order, stamped with its pose; nothing when there is none yet.  Valid until
  /// give_back().
  [[nodiscard]] const profile::ProfileBuffer* take();
  void give_back();

  /// No profile will come any more: the source is at its end, failed, or was stopped, and the ring is empty.
  [[nodiscard]] bool finished() const;
  /// What ended it, if not the end of the source.
  [[nodiscard]] std::optional<Error> failure() const;

  /// Of frames, poses and profiles; the messages' are the server's.  Any thread.
  [[nodiscard]] profile::ScanCounts counts() const;
  /// Profiles that a replay of the frames makes otherwise: stamped before all their poses had come, or
  /// dropped.  From the stream thread, or once it is done with the scan.
  [[nodiscard]] std::uint64_t unrepeatable() const { return stamped_early_ + dropped_.load(); }
  /// The longest time between the exposures of two neighbouring frames under the laser, or from the last one
  /// to `until`.
  [[nodiscard]] Nanoseconds longest_pause(SensorClock::time_point until) const;
  /// Another exposure (0: it stays) and another way to find peaks, between two frames.  At once the same: all
  /// of it or nothing.  Errc::BadValue: peaks that no frame can have.  Pre: none is on its way.
  [[nodiscard]] Result<void> offer_change(Nanoseconds exposure, const stripe::PeakConfig& peaks,
                                          stripe::PeakChoice choice);
  struct Changed {
    Nanoseconds exposure{0};  ///< that the camera took; 0: it stays, and with it the rate
    double rate_max_hz{0};    ///< that it allows now; 0: the camera does not tell
  };
  /// What was changed, or why nothing was; once.  Nothing: not yet, or none was offered.
  [[nodiscard]] std::optional<Result<Changed>> change_done();
  [[nodiscard]] wire::CaptureState capture_state() const { return capture_->state(); }
  [[nodiscard]] Source& source() { return source_; }
  [[nodiscard]] bool has_trigger() const { return source_.trigger != nullptr; }
  /// Where live pictures come from; may outlive the scan.
  [[nodiscard]] const std::shared_ptr<pipeline::PictureTap>& pictures() const { return pictures_; }
  [[nodiscard]] const Config& config() const { return config_; }

  runtime::StageMeter wait_meter, process_meter, stamp_meter;
  runtime::StageMeter adjust_meter;   ///< changes of exposure or rows
  runtime::StageMeter picture_meter;  ///< copies of frames for observers and the recording

 private:
  /// 1.2 s at 100 Hz, for a stream thread that waits for poses or whose turn is held up.  27 MB.
  static constexpr std::size_t k_ring_profiles = 128;
  /// Plus the one being filled plus the one being sent: a buffer is always free for the next frame.
  static constexpr std::size_t k_pool_profiles = k_ring_profiles + 2;

  Scanner(Source source, const Config& config, pipeline::ProfilePipeline pipeline,
          std::unique_ptr<CaptureControl> capture, const hal::Clock& clock, runtime::LaserWatch* laser);
  void acquire();
  void read_poses();
  /// Errc::Refused: the camera is not in the state of its calibration.
  [[nodiscard]] Result<void> look_at_state();
  [[nodiscard]] Result<void> take_change();
  /// A turn after the exposure: the camera is asked for one thing between two frames.
  void ask_rate();
  [[nodiscard]] Result<void> process(const hal::FrameView& frame);
  [[nodiscard]] bool pose_settled();
  void record_failure(const Error& error);
  void keep_pose(const geometry::PoseSample& pose);
  void note_exposure(SensorClock::time_point mid);

  Source source_;
  Config config_;
  pipeline::ProfilePipeline pipeline_;
  std::unique_ptr<CaptureControl> capture_;
  const hal::Clock& clock_;
  runtime::LaserWatch* laser_;
  pipeline::PoseHistory poses_;
  std::shared_ptr<pipeline::PictureTap> pictures_;
  std::shared_ptr<pipeline::RecordTap> recording_;  ///< null: none
  rt::BufferPool<profile::ProfileBuffer, k_pool_profiles> pool_{k_pool_profiles};
  rt::DropOldestRing<rt::BufferIndex, k_ring_profiles> ring_;

  /// From the stream thread to the acquisition and back; its owner is the stream thread.
  struct Change {
    Nanoseconds exposure;
    pipeline::ProfilePipeline::PeakChange peaks;
    Result<Changed> outcome;
    std::atomic<bool> done{false};
  };
  std::unique_ptr<Change> change_;
  std::atomic<Change*> offered_{nullptr};
  Change* rate_wanted_{nullptr};    ///< acquisition's own: taken, but for its highest rate
  Nanoseconds exposure_;            ///< acquisition's own
  bool frame_since_change_{false};  ///< acquisition's own

  std::thread acquisition_thread_, pose_thread_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> acquisition_over_{false};
  std::atomic<bool> poses_over_{false};
  std::atomic<std::int64_t> poses_wanted_until_ns_;
  std::atomic<std::int64_t> last_lit_ns_{0};  ///< newest exposure under the laser; 0: none yet
  std::atomic<std::int64_t> longest_pause_ns_{0};
  std::atomic<std::uint64_t> profiles_{0}, dropped_{0}, rejected_poses_{0}, overruns_{0};

  // Stream thread's own.
  std::optional<rt::BufferIndex> taken_;
  bool stamped_{false};
  std::uint64_t stamped_early_{0};
  SensorClock::time_point taken_at_;

  mutable std::mutex failure_mutex_;
  std::optional<Error> failure_;
};

}  // namespace biteline::sensor
