// SPDX-License-Identifier: MIT
#include "host/intake/live_line.hpp"

#include <pthread.h>

#include <utility>

#include "common/core/contracts.hpp"

namespace biteline::intake {

uncertainty::ProfilePose pose_of(const profile::ProfileHeader& header) {
  const auto since = header.exposure_mid.time_since_epoch();
  return {.T_base_flange = header.T_base_flange,
          .time_s = 1e-9 * static_cast<double>(std::chrono::duration_cast<Nanoseconds>(since).count())};
}

LiveLine::LiveLine(const bite_line::Config& config) : config_{config}, thread_{[this] { work(); }} {
  pthread_setname_np(thread_.native_handle(), "bl-line");
}

LiveLine::~LiveLine() {
  {
    const std::lock_guard lock{mutex_};
    dropped_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LiveLine::add_profile(std::uint64_t sequence, std::span<const Eigen::Vector3f> points_base,
                           const std::optional<uncertainty::ProfilePose>& pose,
                           const cloud::StripeSpan& stripe) {
  {
    const std::lock_guard lock{mutex_};
    BITELINE_EXPECTS(!closed_);
    waiting_.push_back({.sequence = sequence,
                        .points_base = {points_base.begin(), points_base.end()},
                        .pose = pose,
                        .amplitude = {stripe.amplitude.begin(), stripe.amplitude.end()},
                        .width_px = {stripe.width_px.begin(), stripe.width_px.end()},
                        .flags = {stripe.flags.begin(), stripe.flags.end()}});
    last_profile_ = Clock::now();
  }
  changed_.notify_all();
}

void LiveLine::add_profiles(const cloud::PointCloud& cloud, std::span<const TakenFrom> poses) {
  BITELINE_EXPECTS(cloud.profile.size() == cloud.points.size());
  for (std::size_t first = 0; first < cloud.size();) {
    std::size_t end = first;
    while (end < cloud.size() && cloud.profile[end] == cloud.profile[first]) ++end;
    const std::uint32_t number = cloud.profile[first];
    while (!poses.empty() && poses.front().profile < number) poses = poses.subspan(1);
    std::optional<uncertainty::ProfilePose> pose;
    if (!poses.empty() && poses.front().profile == number) pose = poses.front().pose;
    add_profile(number, {cloud.points.data() + first, end - first}, pose, cloud.stripe(first, end - first));
    first = end;
  }
}

void LiveLine::close(std::shared_ptr<const uncertainty::KnownHead> head,
                     const std::optional<uncertainty::ArmGive>& arm_give) {
  {
    const std::lock_guard lock{mutex_};
    config_.head = std::move(head);
    config_.arm_give = arm_give;
    closed_ = true;
  }
  changed_.notify_all();
}

LiveLine::Outcome LiveLine::wait() {
  std::unique_lock lock{mutex_};
  changed_.wait(lock, [this] { return outcome_.has_value() || thrown_; });
  if (thrown_) std::rethrow_exception(thrown_);
  return std::move(*outcome_);
}

std::optional<LiveLine::Profile> LiveLine::next() {
  std::unique_lock lock{mutex_};
  changed_.wait(lock, [this] { return dropped_ || closed_ || !waiting_.empty(); });
  if (dropped_ || waiting_.empty()) return std::nullopt;
  Profile profile = std::move(waiting_.front());
  waiting_.pop_front();
  return profile;
}

void LiveLine::work() noexcept {
  try {
    find_line();
  } catch (...) {
    const std::lock_guard lock{mutex_};
    thrown_ = std::current_exception();
  }
  changed_.notify_all();
}

void LiveLine::find_line() {
  bite_line::LiveScan scan;
  while (const std::optional<Profile> profile = next())
    scan.add_profile(
        profile->sequence, profile->points_base, profile->pose,
        {.amplitude = profile->amplitude, .width_px = profile->width_px, .flags = profile->flags});
  {
    const std::lock_guard lock{mutex_};
    if (dropped_) return;
  }
  Outcome outcome;
  outcome.extraction = scan.finish(config_, &outcome.workings);
  outcome.profiles = scan.profiles();
  {
    const std::lock_guard lock{mutex_};
    outcome.last_profile_to_line_s = std::chrono::duration<double>(Clock::now() - last_profile_).count();
    outcome_ = std::move(outcome);
  }
}

}  // namespace biteline::intake
