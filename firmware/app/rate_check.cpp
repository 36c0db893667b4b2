// SPDX-License-Identifier: MIT
#include "firmware/app/rate_check.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "firmware/runtime/thread_table.hpp"

namespace biteline::sensor {
namespace {

constexpr Nanoseconds k_turn = std::chrono::milliseconds{1};
/// A camera that is triggered shows its first frame well within this.
constexpr Nanoseconds k_first_frame = std::chrono::seconds{5};
constexpr double k_least_kept = 0.95, k_most_late = 0.05, k_most_lost = 0.01, k_most_without_pose = 0.5;

/// The budget of a frame is half the time between two at 100 Hz; a head that takes fewer has more time.
bool budget_counts(double rate_hz) {
  constexpr double k_share = 0.4;
  const std::chrono::duration<double> budget = runtime::threads::k_acquisition.budget;
  return rate_hz <= 0 || budget.count() * rate_hz > k_share;
}

}  // namespace

bool RateCheck::kept() const {
  if (wanted_hz > 0 && profiles_hz + slack_hz < k_least_kept * wanted_hz) return false;
  return profiles_hz > 0 && late_ratio <= k_most_late && lost_ratio <= k_most_lost;
}

bool RateCheck::poses_lacked() const {
  return no_pose_ratio > k_most_without_pose;
}

Result<RateCheck> check_rate(SourceKind& kind, const Scanner::Config& config, const hal::Clock& clock,
                             Nanoseconds duration) {
  BITELINE_ASSIGN(Source source, kind.open());
  BITELINE_ASSIGN(const std::unique_ptr<Scanner> scanner,
                  Scanner::create(std::move(source), config, clock, nullptr));
  BITELINE_TRY(scanner->start());
  std::optional<SensorClock::time_point> first;
  profile::ScanCounts before;
  std::uint64_t taken = 0, without_pose = 0;
  const SensorClock::time_point give_up = clock.now() + k_first_frame;
  while (!first || clock.now() - *first < duration) {
    if (const profile::ProfileBuffer* const profile = scanner->take()) {
      ++taken;
      if ((profile->header.flags & (profile::k_profile_pose_missing | profile::k_profile_pose_stale)) != 0)
        ++without_pose;
      scanner->give_back();
      if (!first) {
        first = clock.now();
        before = scanner->counts();
      }
      continue;
    }
    if (scanner->finished()) break;
    if (!first && clock.now() > give_up) return fail(Errc::Timeout, "no frame of the camera within 5 s");
    std::this_thread::sleep_for(k_turn);
  }
  const profile::ScanCounts after = scanner->counts();
  const double seconds = first ? std::chrono::duration<double>(clock.now() - *first).count() : 0;
  scanner->stop();
  if (const std::optional<Error> failed = scanner->failure()) return tl::unexpected<Error>{*failed};
  if (seconds <= 0) return fail(Errc::Timeout, "no frame of the camera");
  const auto profiles = static_cast<double>(after.profiles - before.profiles);
  const auto lost =
      static_cast<double>(after.frames_lost - before.frames_lost + after.frames_damaged -
                          before.frames_damaged + after.profiles_dropped - before.profiles_dropped);
  const double frames = std::max(1.0, profiles + lost);
  // Laser-off frames and second exposures: two frames make one profile.
  return RateCheck{.wanted_hz = config.model.rate_hz.value_or(0) / (config.capture.pairs() ? 2 : 1),
                   .profiles_hz = profiles / seconds,
                   .slack_hz = 1 / seconds,
                   .late_ratio = budget_counts(config.model.rate_hz.value_or(0))
                                     ? static_cast<double>(after.overruns - before.overruns) / frames
                                     : 0,
                   .lost_ratio = lost / frames,
                   .no_pose_ratio = static_cast<double>(without_pose) /
                                    static_cast<double>(std::max<std::uint64_t>(1, taken))};
}

}  // namespace biteline::sensor
