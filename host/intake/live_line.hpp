// SPDX-License-Identifier: MIT
#pragma once
/// \file The line of a scan that is coming in, worked on beside the thread that takes it in.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "common/profile/profile.hpp"
#include "host/bite_line/live_scan.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/intake/scan_intake.hpp"

namespace biteline::intake {

/// Where the arm was when a profile was taken.
[[nodiscard]] uncertainty::ProfilePose pose_of(const profile::ProfileHeader& header);

/// One scan, one thread of its own (`bl-line`): who takes the scan in only hands points over and never waits
/// for geometry, so that the sensor hears from the host all the time.
///
///     LiveLine line{{}};
///     line.add_profile(sequence, points_base);   // as they come
///     line.close();                              // the last one is in
///     line.wait();                               // on any other thread
///
/// Threads: add_profile() and close() from one thread, wait() from any one.  The queue is not bounded: it
/// holds at most the scan, which the caller keeps anyway.
class LiveLine {
 public:
  explicit LiveLine(const bite_line::Config& config);
  /// What is still to do is dropped.
  ~LiveLine();
  LiveLine(const LiveLine&) = delete;
  LiveLine& operator=(const LiveLine&) = delete;

  /// `pose`: where the arm was, for the line's uncertainty.  `stripe`: at these points, for the materials.
  void add_profile(std::uint64_t sequence, std::span<const Eigen::Vector3f> points_base,
                   const std::optional<uncertainty::ProfilePose>& pose = {},
                   const cloud::StripeSpan& stripe = {});
  /// The profiles of a cloud that has scan order, for a scan that goes on after a restart.  `poses`: of as
  /// many as there are, in the order of their numbers.
  void add_profiles(const cloud::PointCloud& cloud, std::span<const TakenFrom> poses = {});
  /// No more profiles: the closing steps begin.  `head`: the one that scanned, where it is told how well it
  /// is known.  `arm_give`: of the arm, by earlier scans.
  void close(std::shared_ptr<const uncertainty::KnownHead> head = {},
             const std::optional<uncertainty::ArmGive>& arm_give = {});

  struct Outcome {
    bite_line::Extraction extraction;
    std::optional<bite_line::Workings> workings;  ///< what pictures are made of
    std::size_t profiles{0};
    double last_profile_to_line_s{0};  ///< from the last add_profile() to the line, what was waiting included
  };
  /// Throws what the geometry threw, such as std::bad_alloc: who waits knows which scan it is about.
  /// Pre: close() has been called or will be.  Call once.
  [[nodiscard]] Outcome wait();

 private:
  using Clock = std::chrono::steady_clock;
  struct Profile {
    std::uint64_t sequence{0};
    std::vector<Eigen::Vector3f> points_base;
    std::optional<uncertainty::ProfilePose> pose{};
    std::vector<float> amplitude{}, width_px{};
    std::vector<std::uint16_t> flags{};
  };

  void work() noexcept;
  void find_line();
  /// The next profile; nothing once all are done and no more will come, or when everything is to be dropped.
  [[nodiscard]] std::optional<Profile> next();

  bite_line::Config config_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Profile> waiting_;
  Clock::time_point last_profile_{Clock::now()};
  bool closed_{false};
  bool dropped_{false};
  std::optional<Outcome> outcome_;
  std::exception_ptr thrown_;
  std::thread thread_;  ///< last: it uses all of the above
};

}  // namespace biteline::intake
