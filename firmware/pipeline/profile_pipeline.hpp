// SPDX-License-Identifier: MIT
#pragma once
/// \file One frame's way: stripe peaks, which peak, averaging, triangulation, robot pose.

#include <memory>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/profile/profile.hpp"
#include "common/rt/annotations.hpp"
#include "common/stripe/line_average.hpp"
#include "common/stripe/peak_extractor.hpp"
#include "common/stripe/peak_selector.hpp"
#include "firmware/pipeline/pose_history.hpp"
#include "firmware/pipeline/triangulation_table.hpp"
#include "hal/api/frame.hpp"

namespace biteline::pipeline {

struct ExposedStripe;

/// Makes profiles of frames.  Two steps, since the pose of a frame is best known a little later, when poses
/// after the exposure have arrived (the smoothing window is centred):
///
///     if (pipeline.rt_process(frame, profile)) ...            // at once; the frame may be given back then
///     ...
///     if (pipeline.rt_pose_ready(profile, poses) || waited_long_enough)
///       pipeline.rt_stamp(profile, poses);                    // in the order of the frames
///
/// After rt_process a profile carries k_profile_pose_missing; rt_stamp clears it and sets stale and
/// extrapolated as they are.  A profile stamped early is right, only its pose is less smoothed and, without
/// any later pose, extrapolated.
///
/// Frames flagged k_frame_laser_off make no profile: they are kept and taken off the lit frames that follow
/// soon.  With Config::bracketing two frames, the second flagged k_frame_second_exposure, make one profile:
/// per column the longer exposure's point unless it is flagged or saturated there (black leather beside white
/// foam) and did not take the shorter one's for a mirror image; flagged k_point_second_exposure and carried
/// to the first exposure's instant by the arm's own motion in rt_stamp.
///
/// Thread: rt_process keeps state from frame to frame and belongs to one thread; rt_pose_ready and rt_stamp
/// are const and may run on another one.  RT: rt_ members.  Memory: all sized in create(), some megabytes.
class ProfilePipeline {
 public:
  struct Config {
    stripe::PeakConfig peaks{};
    stripe::SelectorConfig selector{};
    stripe::LineAverageConfig line_average{};
    geometry::PoseSmoothing pose_smoothing{};
    bool bracketing{false};
    bool keep_second_peaks{true};  ///< the peaks not chosen go along as evidence, flagged k_point_reflection
    Nanoseconds ambient_max_age{
        std::chrono::milliseconds{50}};  ///< older laser-off frames are of another place
    double stripe_lost_ratio{0.02};      ///< fewer columns than this with a point: k_profile_stripe_lost
  };

  /// Fails on a region larger than stripe::k_max_columns, a region whose rays miss the laser plane, a bad
  /// config.
  [[nodiscard]] static Result<ProfilePipeline> create(const Config& config,
                                                      const geometry::SensorModel& sensor);

  /// Another way to find peaks in the same region, made beforehand.
  struct PeakChange {
    stripe::PeakExtractor extractor;  ///< after rt_take_peaks(): the one before
    stripe::PeakChoice choice{stripe::PeakChoice::Continuity};
  };
  /// Fails as create() does.  Another thread may ask while frames are processed.
  [[nodiscard]] Result<PeakChange> prepare_peaks(const stripe::PeakConfig& peaks,
                                                 stripe::PeakChoice choice) const;

  ProfilePipeline(ProfilePipeline&&) noexcept;
  ProfilePipeline& operator=(ProfilePipeline&&) noexcept;
  ~ProfilePipeline();

  /// Fills `out` but for the pose; header.sequence counts the profiles from 0.  False: no profile yet (a
  /// laser-off frame, or the first of a bracket).  Pre: the frame is as wide as the region and shows rows of
  /// it.
  bool rt_process(const hal::FrameView& frame, profile::ProfileBuffer& out) noexcept BITELINE_RT;

  /// From the next frame on.  Thread: that of rt_process.
  void rt_take_peaks(PeakChange& change) noexcept BITELINE_RT;

  /// True when later poses would not change the stamp any more.
  [[nodiscard]] bool rt_pose_ready(const profile::ProfileBuffer& profile,
                                   const PoseHistory& poses) const noexcept BITELINE_RT;

  /// Writes pose, age and flags into the header from the poses that are there, adds the pose's own scatter to
  /// the points' standard deviations, and carries a bracket's second points to exposure_mid.  Pre: once per
  /// profile.
  void rt_stamp(profile::ProfileBuffer& profile, const PoseHistory& poses) const noexcept BITELINE_RT;

 private:
  struct State;
  void rt_make_profile(const ExposedStripe& first, const ExposedStripe* second,
                       profile::ProfileBuffer& out) noexcept BITELINE_RT;
  explicit ProfilePipeline(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::pipeline
